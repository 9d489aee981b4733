#include "offline/bag_check.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <optional>

#include <nlohmann/json.hpp>

#include "offline/double_rectification.h"
#include "offline/frame_loader.h"
#include "offline/frame_outputs.h"

namespace cbmv {
namespace {

constexpr double kLargeOffsetPx = 0.5;  // limit for the rows of a rectified pair
constexpr int kTimedFrames = 3;

template <typename... Values>
std::string format(const char* pattern, Values... values) {
  std::array<char, 512> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void describeBags(const BagSet& bags, const FramePlan& plan, BagCheck& check) {
  check.text = bags.names() + ", " + format("%.1f s:\n", plan.end.toSec() - plan.begin.toSec()) +
               bags.describeTopics();
  for (const std::string& damage : bags.damages()) {
    check.problems.push_back(damage);
  }
}

void describePairs(const FramePlan& plan, BagCheck& check) {
  check.text += "pairs: " + plan.topics.left.name + " and " + plan.topics.right.name + "\n  " +
                plan.topics.rectification + "\n" +
                format("  %zu left and %zu right images, %zu pairs, %zu to process\n",
                       plan.left_images, plan.right_images, plan.pairs, plan.frames.size());
  const PlanProblems problems = findProblems(plan);
  if (!problems.nothing_to_process.empty()) {
    check.problems.push_back(problems.nothing_to_process);
  }
  check.problems.insert(check.problems.end(), problems.others.begin(), problems.others.end());
  if (plan.infos_of_other_stamps > 0) {
    check.text +=
        format("  %zu pairs have no camera_info with their stamp and use the last one before\n",
               plan.infos_of_other_stamps);
  }
}

void describeCalibration(const PreparedPair& frame, const VerticalOffsetMeasurement& offset,
                         const DisparityRange& range, BagCheck& check) {
  const StereoGeometry& geometry = frame.geometry;
  const double depth_factor = geometry.focal_length_px * geometry.baseline_m;
  check.text +=
      format("calibration: focal length %.1f px, baseline %.4f m, images of %d x %d px\n",
             geometry.focal_length_px, geometry.baseline_m, frame.images.left.cols,
             frame.images.left.rows) +
      format("  disparities up to %d px: nearest depth %.2f m; 1 px at 10 m is %.2f m\n",
             range.max(), depth_factor / std::max(1.0, range.max() - geometry.disparity_offset_px),
             100 / depth_factor);
  if (offset.model.matches == 0) {
    check.text += "  vertical offset: not measured, too few matches\n";
    return;
  }
  const double rms_px = offset.rms_before_px;
  check.text +=
      format("  vertical offset: %.2f px (RMS of %d matches)\n", rms_px, offset.model.matches);
  if (rms_px > kLargeOffsetPx) {
    check.problems.push_back(format(
        "the vertical offset of the pair is %.2f px (RMS), expected at most %.1f px. It is "
        "corrected, but depth may be wrong. Rectify the images or calibrate the cameras again",
        rms_px, kLargeOffsetPx));
  }
}

void describeCost(const FramePlan& plan, FrameProcessor& processor, const PreparedPair& frame,
                  const VerticalOffset& vertical_offset, BagCheck& check) {
  GivenOffset offset(vertical_offset);
  processor.match(frame, offset);  // the first frame allocates memory
  const double begin_s = steadySeconds();
  const std::clock_t begin_clock = std::clock();
  for (int i = 0; i < kTimedFrames; ++i) {
    processor.match(frame, offset);
  }
  check.matching_s = (steadySeconds() - begin_s) / kTimedFrames;
  check.cpu_s = static_cast<double>(std::clock() - begin_clock) / CLOCKS_PER_SEC / kTimedFrames;
  check.image_size = frame.images.left.size();
  const double all_s = check.matching_s * static_cast<double>(plan.frames.size());
  check.text += format(
      "cost: %.1f ms wall time per frame (%.1f ms CPU time), %.3g frames/s, about %.0f s in "
      "total\n",
      1000 * check.matching_s, 1000 * check.cpu_s, 1 / check.matching_s, std::ceil(all_s));
}

/// The middle frame; none, and a problem, if it cannot be used.
std::optional<PreparedFrame> prepareOne(const FramePlan& plan, const FrameProcessor& processor,
                                        bool allow_different_frame_ids, BagCheck& check) {
  if (plan.frames.empty()) {
    return std::nullopt;
  }
  try {
    FrameLoader loader(plan.topics, false);
    return prepareFrame(loader.load(plan.frames[plan.frames.size() / 2]), loader.topicNames(),
                        loader.rectifiedBy(), allow_different_frame_ids, processor);
  } catch (const InputError& error) {
    check.problems.emplace_back(error.what());
    return std::nullopt;
  }
}

}  // namespace

std::string checkJson(const BagCheck& check) {
  const nlohmann::json json = {{"frames", check.frames},
                               {"width", check.image_size.width},
                               {"height", check.image_size.height},
                               {"matching_ms", 1000 * check.matching_s},
                               {"cpu_ms", 1000 * check.cpu_s},
                               {"problems", check.problems}};
  return json.dump(2) + "\n";
}

BagCheck checkBags(const BagProcessingOptions& options,
                   const std::shared_ptr<const Forest>& forest) {
  const BagSet bags(options.inputs);
  const FramePlan plan = planFrames(bags, findCameraTopics(bags, options.topics), options.plan);
  compressionOf(options.compression);
  const FrameOutputs outputs(options.outputs,
                             plan.topics);  // rejects the same options as processing
  BagCheck check;
  check.frames = plan.frames.size();
  describeBags(bags, plan, check);
  describePairs(plan, check);
  if (plan.topics.left.raw && !plan.frames.empty()) {
    const std::string warning =
        doubleRectificationWarning(plan.topics, plan.frames.front(), options.matching.stereo);
    if (!warning.empty()) {
      check.problems.push_back(warning);
    }
  }
  FrameProcessor processor(forest, options.matching.stereo);
  if (const auto frame =
          prepareOne(plan, processor, options.matching.allow_different_frame_ids, check)) {
    describeCalibration(frame->pair, processor.measureOffset(frame->pair),
                        processor.rangeOf(frame->pair), check);
    check.problems.insert(check.problems.end(), frame->pair.warnings.begin(),
                          frame->pair.warnings.end());
    describeCost(plan, processor, frame->pair, processor.estimateOffset(frame->pair), check);
  }
  return check;
}

}  // namespace cbmv
