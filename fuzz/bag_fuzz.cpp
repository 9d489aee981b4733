// Whole bags: records, topics, pairing and the first frames.

#include <algorithm>

#include "fuzz_target.h"
#include "offline/bag_set.h"
#include "offline/frame_loader.h"
#include "offline/frame_plan.h"
#include "offline/stereo_topics.h"
#include "ros/image_conversion.h"
#include "scratch_file.h"

namespace {

constexpr std::size_t kFrames = 4;

void convert(const cbmv::LoadedFrame& frame, const cbmv::StereoTopics& topics) {
  const cbmv::StereoInput input = cbmv::toStereoInput(frame.messages, topics, true);
  cbmv::toGrayPair(input);
  cbmv::requireUsable(cbmv::checkCalibration(*input.cameras, input.left.size(), input.names,
                                             cbmv::RectifiedBy::kUs));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const cbmv::fuzz::ScratchFile file(data, size);
  return cbmv::fuzz::attempt([&] {
    const cbmv::BagSet bags({file.path()});
    bags.describeTopics();
    const auto topics = cbmv::findCameraTopics(bags, {});
    const cbmv::FramePlan plan = cbmv::planFrames(bags, topics, {});
    cbmv::FrameLoader loader(topics, true);
    for (std::size_t i = 0; i < std::min(kFrames, plan.frames.size()); ++i) {
      cbmv::fuzz::attempt([&] { convert(loader.load(plan.frames[i]), loader.topicNames()); });
    }
  });
}
