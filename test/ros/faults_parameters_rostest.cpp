// Run by faults.test: hundreds of calls of set_parameters with values at, below and above their
// limits, while frames are processed.

#include <cmath>
#include <limits>
#include <vector>

#include "ros/fault_fixture.h"
#include "ros/rostest_main.h"

namespace cbmv {
namespace {

using dynamic_reconfigure::Config;
constexpr int kCalls = 400;

class ParameterFaults : public FaultTest {
 protected:
  /// The configuration that the node returns for these values.
  static cbmv_stereo::StereoConfig call(const Config& request) {
    dynamic_reconfigure::Reconfigure call;
    call.request.config = request;
    EXPECT_TRUE(ros::service::call(shared->nh.resolveName("cbmv_stereo/set_parameters"), call));
    auto config = cbmv_stereo::StereoConfig::__getDefault__();
    config.__fromMessage__(call.response.config);
    return config;
  }

  template <typename List, typename Value>
  static void add(const std::string& name, Value value, List& list) {
    list.emplace_back();
    list.back().name = name;
    list.back().value = value;
  }

  template <typename Values>
  static auto anyOf(const Values& values) {
    return values[static_cast<std::size_t>(random().uniform(0, static_cast<int>(values.size())))];
  }
  static cv::RNG& random() {
    static cv::RNG generator(11);
    return generator;
  }

  static double anyNumber(double lowest, double highest) {
    const double infinity = std::numeric_limits<double>::infinity();
    return anyOf(std::vector<double>{lowest, highest, lowest - 1, highest + 1, -infinity, infinity,
                                     std::nan(""), -1e308, 1e-308,
                                     random().uniform(lowest, highest)});
  }
  static int anyInteger(double lowest, double highest) {
    return anyOf(std::vector<int>{static_cast<int>(lowest), static_cast<int>(highest),
                                  static_cast<int>(lowest) - 1, static_cast<int>(highest) + 1,
                                  std::numeric_limits<int>::min(), std::numeric_limits<int>::max(),
                                  static_cast<int>(random().uniform(lowest, highest))});
  }

  static void addAnyValue(const Parameter& parameter, Config& config) {
    if (std::holds_alternative<bool>(parameter.default_value)) {
      add(parameter.name, random().uniform(0, 2) == 1, config.bools);
    } else if (std::holds_alternative<int>(parameter.default_value)) {
      add(parameter.name, anyInteger(parameter.lowest, parameter.highest), config.ints);
    } else {
      add(parameter.name, anyNumber(parameter.lowest, parameter.highest), config.doubles);
    }
  }

  /// Random values of a few parameters, or of all.
  static Config anyRequest(const std::vector<Parameter>& parameters) {
    Config config;
    const int one_in = anyOf(std::vector<int>{1, 4, 20});
    for (const Parameter& parameter : parameters) {
      if (random().uniform(0, one_in) == 0) {
        addAnyValue(parameter, config);
      }
    }
    if (random().uniform(0, 10) == 0) {
      add("preset",
          anyOf(std::vector<std::string>{"", "custom", "quality", "realtime", "no such",
                                         "/dev/null", "/", ".yaml", std::string(10000, '/'),
                                         "\xff\xfe"}),
          config.strs);
      add("min_confidence", anyNumber(0, 1), config.doubles);
      add("no_such_parameter", 1, config.ints);
    }
    return config;
  }

  static void expectWithinLimits(const cbmv_stereo::StereoConfig& config,
                                 const std::vector<Parameter>& parameters) {
    StereoOptions options;
    applyConfig(config, options);  // throws for invalid values
    for (const Parameter& parameter : parameters) {
      std::visit(
          [&](const auto& value) {
            EXPECT_GE(value, static_cast<float>(parameter.lowest)) << parameter.name;
            EXPECT_LE(value, static_cast<float>(parameter.highest)) << parameter.name;
          },
          parameter.get(options));
    }
    EXPECT_TRUE(config.min_confidence >= 0 && config.min_confidence <= 1);
  }
};

TEST_F(ParameterFaults, AtAndBeyondTheirLimitsWhileFramesFlow) {
  const std::vector<Parameter> parameters = stereoParameters();
  {
    const Feeder frames(0.01, [] { shared->client.cameras.publish(goodPair()); });
    for (int i = 0; i < kCalls; ++i) {
      SCOPED_TRACE(i);
      expectWithinLimits(call(anyRequest(parameters)), parameters);
      wait(0.005);
    }
  }
  shared->client.setOptions(testOptions());
  expectRightAgain();
}

/// One at a time, with frames in between.
TEST_F(ParameterFaults, EachAtItsLimits) {
  for (const Parameter& parameter : stereoParameters()) {
    SCOPED_TRACE(parameter.name);
    for (const double value : {parameter.lowest, parameter.highest}) {
      Config request;
      if (std::holds_alternative<bool>(parameter.default_value)) {
        add(parameter.name, value > 0, request.bools);
      } else if (std::holds_alternative<int>(parameter.default_value)) {
        add(parameter.name, static_cast<int>(value), request.ints);
      } else {
        add(parameter.name, value, request.doubles);
      }
      call(request);
      // Disparities outside the images, and settings that need too much memory, are rejected with a
      // message.
      if (parameter.name != "min_disparity") {
        EXPECT_TRUE(disparityOfAGoodPair()) << value;
      }
      shared->client.setOptions(testOptions());
      expectRightAgain();
    }
  }
}

TEST_F(ParameterFaults, ThatAreNoNumbersAreNamed) {
  Config request;
  add("P1", std::nan(""), request.doubles);
  EXPECT_FLOAT_EQ(call(request).P1, StereoOptions().sgm.p1);
  expectDiagnostic("Method", Level::OK, "P1 is nan");
  request = {};
  add("min_confidence", std::nan(""), request.doubles);
  EXPECT_EQ(call(request).min_confidence, 0);
  expectDiagnostic("Method", Level::OK, "min_confidence is not a number");
  expectRightAgain();
}

TEST_F(ParameterFaults, DisparitiesOutsideOfTheImagesAreNamed) {
  Config request;
  add("min_disparity", 2048, request.ints);
  call(request);
  shared->client.cameras.publish(goodPair());
  expectDiagnostic("Calibration", Level::ERROR, "2048 ... 2063 px");
  shared->client.setOptions(testOptions());
  expectRightAgain();
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
