// Forest files of this package and of XGBoost. Valid forests are also evaluated.

#include <array>
#include <cstring>
#include <numeric>
#include <vector>

#include "forest/confidence_evaluator.h"
#include "forest/forest_evaluator.h"
#include "forest/forest_file.h"
#include "fuzz_target.h"
#include "io/bounded_json.h"
#include "io/crc32_text.h"
#include "io/ordered_json.h"

namespace {

constexpr int kHypotheses = cbmv::CodeBlock::kHypotheses;

/// Uses all codes of a byte and values from 0 to the largest feature value.
void evaluate(const cbmv::ForestEvaluator& evaluator) {
  std::vector<std::uint8_t> costs(kHypotheses);
  if (!evaluator.wantsValues()) {
    cbmv::CodeBlock codes{};
    for (auto& line : codes.lines) {
      std::iota(line.begin(), line.end(), std::int8_t{-128});
    }
    evaluator.evaluate(codes, kHypotheses, costs.data());
    return;
  }
  std::vector<float> line(kHypotheses);
  for (int i = 0; i < kHypotheses; ++i) {
    line[i] = 1e30F * static_cast<float>(i) / kHypotheses;
  }
  std::array<const float*, cbmv::kFeatureCount> lines{};
  lines.fill(line.data());
  evaluator.evaluate(lines, kHypotheses, costs.data());
}

void evaluate(const cbmv::ConfidenceForest& forest) {
  cbmv::ConfidenceCodes codes(forest);
  for (std::size_t f = 0; f < forest.feature_names.size(); ++f) {
    std::int8_t* line = codes.line(static_cast<int>(f));
    std::iota(line, line + kHypotheses, std::int8_t{-128});
  }
  std::vector<float> probabilities(kHypotheses);
  cbmv::ConfidenceEvaluator(forest).evaluate(codes, kHypotheses, probabilities.data());
}

/// Sets the correct checksum, which random changes would not find. Returns the text unchanged if it
/// has no checksum field.
std::string withChecksum(const std::string& text) {
  try {
    auto json = cbmv::parseBounded<cbmv::OrderedJson>(text);
    if (json.is_object() && json.contains("model")) {
      json["checksum"] = cbmv::crc32Text(json["model"].dump());
      return json.dump();
    }
  } catch (const std::exception&) {  // parseForest reports the error
  }
  return text;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  cbmv::fuzz::attempt([&] { cbmv::parseForest(text, "input.forest"); });
  return cbmv::fuzz::attempt([&] {
    const cbmv::Forest forest = cbmv::parseForest(withChecksum(text), "input.forest");
    const cbmv::ForestEvaluator evaluator(forest);
    evaluate(evaluator);
    for (const cbmv::ConfidenceStage& stage : cbmv::kConfidenceStages) {
      if (forest.*stage.forest != nullptr) {
        evaluate(*(forest.*stage.forest));
      }
    }
    cbmv::forestChecksum(forest);
  });
}
