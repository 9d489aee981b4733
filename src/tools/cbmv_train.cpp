// Trains a forest on pairs with ground truth.

#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "run_tool.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/forest/forest_file.h"
#include "cbmv_stereo/training/forest_training.h"

int main(int argc, char** argv) {
  CLI::App app{"Trains a forest on rectified stereo pairs with ground truth"};
  std::string dataset;
  std::string output;
  cbmv::TrainingOptions options;
  app.add_option("--dataset", dataset,
                 "KIND:DIR; KIND is middlebury_v3 (folders with im0.png, im1.png, disp0GT.pfm)")
      ->required();
  app.add_option("--scenes", options.scenes, "Only these scenes, separated by commas")
      ->delimiter(',');
  app.add_option("--exclude", options.excluded_scenes, "All but these scenes, separated by commas")
      ->delimiter(',');
  app.add_option("--output", output, "The forest to write")->required();
  app.add_option("--pixels-per-scene", options.pixels_per_scene,
                 "Pixels drawn from each scene; each gives up to three samples")
      ->capture_default_str();
  app.add_option("--seed", options.seed, "Of the drawing")->capture_default_str();
  app.add_option("--trees", options.boosting.trees)->capture_default_str();
  app.add_option("--depth", options.boosting.depth, "Levels a tree")->capture_default_str();
  app.add_option("--learning-rate", options.boosting.learning_rate)->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }

  return cbmv::runTool("cbmv_train", [&] {
    const cbmv::Forest forest = cbmv::trainOnDataSet(
        dataset, options, [](const std::string& line) { std::printf("%s\n", line.c_str()); });
    cbmv::writeForest(forest, output);
    std::printf("wrote %s: %zu trees, %ld samples, held-out log-loss %.4f\n", output.c_str(),
                forest.trees.size(), forest.provenance.samples,
                forest.provenance.held_out_log_loss);
  });
}
