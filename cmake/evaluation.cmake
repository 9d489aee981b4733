# Data sets with ground truth, scores and rendered scenes; training and tuning. Static libraries for the
# command-line programs and tests. No node loads them.
file(GLOB evaluation_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/data_sets/*.cpp
     ${PROJECT_SOURCE_DIR}/src/evaluation/*.cpp)
add_library(cbmv_evaluation STATIC EXCLUDE_FROM_ALL ${evaluation_sources})
target_link_libraries(cbmv_evaluation PUBLIC cbmv_core PRIVATE nlohmann_json::nlohmann_json ZLIB::ZLIB)

if(CBMV_WITH_TRAINING)
  file(GLOB training_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/training/*.cpp
       ${PROJECT_SOURCE_DIR}/src/tuning/*.cpp)
  add_library(cbmv_training STATIC ${training_sources})
  target_compile_definitions(cbmv_training PRIVATE CBMV_VERSION="${PROJECT_VERSION}")
  target_link_libraries(cbmv_training PUBLIC cbmv_evaluation
    PRIVATE xgboost_c_api NLopt::nlopt nlohmann_json::nlohmann_json)
endif()
