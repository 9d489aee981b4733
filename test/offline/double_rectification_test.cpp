#include "offline/double_rectification.h"

#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluation/rendered_scene.h"
#include "recording.h"
#include "ros/raw_rig.h"

namespace cbmv {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

PairMessages rectifiedPair() {
  const RenderedScene scene = renderScene(220, 160, 1, {});
  return makeMessages({scene.left, scene.right, {}}, {185, 0.1, 109.5, 109.5, 79.5},
                      ros::Time(100));
}

/// The same lens with this fraction of its distortion, rotation and decentering.
Lens weakened(const Lens& lens, double share) {
  Lens weak = lens;
  weak.matrix =
      cv::Matx33d(185, 0, 109.5, 0, 185, 79.5, 0, 0, 1) * (1 - share) + lens.matrix * share;
  for (double& coefficient : weak.distortion) {
    coefficient *= share;
  }
  weak.rotation *= share;
  return weak;
}

class DoubleRectification : public testing::Test {
 protected:
  /// The warning for a bag of the pair as raw images.
  std::string warning(const PairMessages& messages) {
    const FramePlan plan = planOf(messages, {});
    return doubleRectificationWarning(plan.topics, plan.frames.at(0), options_);
  }
  /// The warning for a bag of the pair as rectified images.
  std::string offsetWarning(const PairMessages& messages) {
    TopicChoice as_they_are;
    as_they_are.rectified = Rectified::kYes;
    const FramePlan plan = planOf(messages, as_they_are);
    return verticalOffsetWarning(plan.topics, plan.frames.at(0), options_);
  }

 private:
  FramePlan planOf(const PairMessages& messages, const TopicChoice& choice) {
    rosbag::Bag bag(input_, rosbag::bagmode::Write);
    for (const bool right : {false, true}) {
      const std::string camera = right ? "/right" : "/left";
      bag.write(camera + "/image_raw", ros::Time(100),
                right ? messages.right_image : messages.left_image);
      bag.write(camera + "/camera_info", ros::Time(100),
                right ? messages.right_info : messages.left_info);
    }
    bag.close();
    bags_.emplace(std::vector<std::string>{input_});
    options_.range = {0, 48};
    return planFrames(*bags_, findCameraTopics(*bags_, choice), {});
  }

  TemporaryFolder folder_;
  std::string input_ = folder_.file("in.bag");
  StereoOptions options_;
  std::optional<BagSet> bags_;  ///< source of the planned frames
};

/// With weak distortion, the rows of raw images are nearly aligned.
TEST_F(DoubleRectification, IsNotSuspectedOfRawImages) {
  for (const double share : {1.0, 0.3, 0.1, 0.03, 0.01}) {
    PairMessages messages = rectifiedPair();
    makeRaw(weakened(kLeftLens, share), weakened(kRightLens, share), messages);
    EXPECT_THAT(warning(messages), IsEmpty()) << share;
  }
}

TEST_F(DoubleRectification, IsSuspectedWhereRowsAreWorseAfterwards) {
  for (const double share : {1.0, 0.3}) {
    PairMessages messages = rectifiedPair();
    weakened(kLeftLens, share).describe(*messages.left_info);
    weakened(kRightLens, share).describe(*messages.right_info);
    EXPECT_THAT(warning(messages), HasSubstr("use --rectified yes")) << share;
  }
}

TEST_F(DoubleRectification, IsNotTakenForACalibrationThatDoesNotFit) {
  PairMessages messages = rectifiedPair();
  Lens left = weakened(kLeftLens, 0);
  Lens right = weakened(kRightLens, 0);
  left.rotation = {0.006, 0, 0};
  right.rotation = {-0.006, 0, 0};
  makeRaw(left, right, messages);
  left.rotation *= -1;
  right.rotation *= -1;
  left.describe(*messages.left_info);
  right.describe(*messages.right_info);
  EXPECT_THAT(warning(messages), HasSubstr("The calibration does not match the images"));
}

/// Raw images whose topics have names of rectified images.
TEST_F(DoubleRectification, RowsOfRawImagesTakenAsRectifiedAreWarnedOf) {
  PairMessages messages = rectifiedPair();
  EXPECT_THAT(offsetWarning(messages), IsEmpty());
  Lens left = weakened(kLeftLens, 0);
  Lens right = weakened(kRightLens, 0);
  left.rotation = {0.006, 0, 0};
  right.rotation = {-0.006, 0, 0};
  makeRaw(left, right, messages);
  EXPECT_THAT(offsetWarning(messages), HasSubstr("px, expected at most 1.00 px"));
  EXPECT_THAT(offsetWarning(messages), HasSubstr("Use --rectified no"));
}

}  // namespace
}  // namespace cbmv
