#include "tools/rig_calibration.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "support/error_text.h"

namespace cbmv {
namespace {

const cv::Size kSize(640, 480);
const Chessboard kBoard{{9, 6}, 0.03};

/// A rig whose right camera is slightly rotated and raised.
struct KnownRig {
  cv::Matx33d left_matrix{530, 0, 330, 0, 532, 235, 0, 0, 1};
  cv::Matx33d right_matrix{536, 0, 312, 0, 537, 246, 0, 0, 1};
  std::vector<double> left_distortion{-0.27, 0.08, 0.001, -0.0005, 0};
  std::vector<double> right_distortion{-0.25, 0.06, -0.0008, 0.0006, 0};
  cv::Vec3d rotation{0.01, -0.02, 0.006};  ///< from left to right, Rodrigues
  cv::Vec3d translation{-0.11, 0.002, -0.001};

  cv::Matx33d turn() const {
    cv::Matx33d matrix;
    cv::Rodrigues(rotation, matrix);
    return matrix;
  }
};

/// Poses of the board in front of the left camera: rotated in all directions, all over the image.
std::vector<std::pair<cv::Vec3d, cv::Vec3d>> boardPoses() {
  cv::RNG random(7);
  std::vector<std::pair<cv::Vec3d, cv::Vec3d>> poses;
  for (int i = 0; i < 12; ++i) {
    const auto turn = [&] { return random.uniform(-0.5, 0.5); };
    poses.push_back({{turn(), turn(), turn() / 2},
                     {-0.1 + random.uniform(-0.1, 0.1), -0.08 + random.uniform(-0.08, 0.08),
                      0.5 + random.uniform(0.0, 0.3)}});
  }
  return poses;
}

/// Both projections of the board in a pose, from the pinhole model with plumb_bob.
BoardView project(const KnownRig& rig, const cv::Vec3d& turn, const cv::Vec3d& shift) {
  BoardView view;
  cv::projectPoints(kBoard.points(), turn, shift, rig.left_matrix, rig.left_distortion, view.left);
  cv::Vec3d right_turn, right_shift;
  cv::composeRT(turn, shift, rig.rotation, rig.translation, right_turn, right_shift);
  cv::projectPoints(kBoard.points(), right_turn, right_shift, rig.right_matrix,
                    rig.right_distortion, view.right);
  return view;
}

std::vector<BoardView> projectAll(double noise_px) {
  cv::RNG random(3);
  std::vector<BoardView> views;
  for (const auto& [turn, shift] : boardPoses()) {
    views.push_back(project({}, turn, shift));
    for (BoardCorners* corners : {&views.back().left, &views.back().right}) {
      for (cv::Point2f& corner : *corners) {
        corner.x += static_cast<float>(random.gaussian(noise_px));
        corner.y += static_cast<float>(random.gaussian(noise_px));
      }
    }
  }
  return views;
}

TEST(RigCalibration, FindsTheRigThatTheCornersAreOf) {
  const CalibratedRig found = calibrateRig(projectAll(0), kBoard, kSize);
  const KnownRig rig;
  EXPECT_LT(cv::norm(found.left.matrix, rig.left_matrix, cv::NORM_INF), 0.05);
  EXPECT_LT(cv::norm(found.right.matrix, rig.right_matrix, cv::NORM_INF), 0.05);
  ASSERT_EQ(found.left.distortion.size(), 5U);
  EXPECT_NEAR(found.left.distortion[0], rig.left_distortion[0], 1e-3);
  EXPECT_NEAR(found.right.distortion[2], rig.right_distortion[2], 1e-4);
  EXPECT_NEAR(found.baselineM(), cv::norm(rig.translation), 1e-4);
  EXPECT_LT(found.reprojection_error_px, 0.001);
  EXPECT_LT(found.epipolar_error_px, 0.001);
  EXPECT_EQ(found.image_size, kSize);
}

/// From the definition of CameraInfo: P R X is the rectified image position of point X in camera
/// coordinates.
TEST(RigCalibration, RectifiesPointsToOneRow) {
  const CalibratedRig found = calibrateRig(projectAll(0), kBoard, kSize);
  const KnownRig rig;
  for (const cv::Vec3d& point :
       {cv::Vec3d(0, 0, 1), cv::Vec3d(-0.5, 0.3, 2), cv::Vec3d(1, -1, 7)}) {
    const cv::Vec3d seen_by_right = rig.turn() * point + rig.translation;
    const auto pixel = [](const CalibratedCamera& camera, const cv::Vec3d& of_camera) {
      const cv::Vec3d turned = camera.rotation * of_camera;
      const cv::Matx33d matrix = camera.projection.get_minor<3, 3>(0, 0);
      const cv::Vec3d homogeneous = matrix * turned;
      return cv::Vec3d(homogeneous[0] / homogeneous[2], homogeneous[1] / homogeneous[2], turned[2]);
    };
    const cv::Vec3d left = pixel(found.left, point);
    const cv::Vec3d right = pixel(found.right, seen_by_right);
    EXPECT_NEAR(left[1], right[1], 0.02);
    // Z = f T / d
    const double disparity = left[0] - right[0];
    EXPECT_NEAR(-found.right.projection(0, 3) / disparity, left[2], 0.002 * left[2]);
  }
  EXPECT_EQ(found.left.projection(0, 2), found.right.projection(0, 2));
  EXPECT_EQ(found.left.projection(0, 3), 0);
}

TEST(RigCalibration, ErrorsAreThoseOfTheCorners) {
  constexpr double kNoisePx = 0.2;
  const CalibratedRig found = calibrateRig(projectAll(kNoisePx), kBoard, kSize);
  // Two coordinates per corner; two rows per pair, whose noise is increased by removing barrel
  // distortion.
  EXPECT_NEAR(found.reprojection_error_px, kNoisePx * std::sqrt(2), 0.02);
  EXPECT_GT(found.epipolar_error_px, kNoisePx * std::sqrt(2));
  EXPECT_LT(found.epipolar_error_px, kNoisePx * std::sqrt(2) * 1.2);
  EXPECT_NEAR(found.baselineM(), cv::norm(KnownRig().translation), 0.002);
}

TEST(RigCalibration, RejectsTooFewViewsAndIncompleteOnes) {
  std::vector<BoardView> views = projectAll(0);
  views.resize(3);
  views[1].right.pop_back();
  EXPECT_TRUE(mentions(errorText([&] { calibrateRig(views, kBoard, kSize); }), {"54", "53"}));
  views.resize(2);
  EXPECT_TRUE(mentions(errorText([&] { calibrateRig(views, kBoard, kSize); }), {"2 pairs", "3"}));
}

/// The board seen by a camera without distortion, drawn at four times the size and downscaled.
cv::Mat drawBoard(const cv::Matx33d& matrix, const cv::Vec3d& turn, const cv::Vec3d& shift) {
  constexpr int kSquarePx = 40;
  const cv::Size squares(kBoard.corners.width + 1, kBoard.corners.height + 1);
  cv::Mat flat(squares.height * kSquarePx, squares.width * kSquarePx, CV_8UC1, cv::Scalar(230));
  for (int row = 0; row < squares.height; ++row) {
    for (int column = row % 2; column < squares.width; column += 2) {
      flat(cv::Rect(column * kSquarePx, row * kSquarePx, kSquarePx, kSquarePx)).setTo(20);
    }
  }
  cv::Matx33d rotation;
  cv::Rodrigues(turn, rotation);
  const cv::Matx33d pose(rotation(0, 0), rotation(0, 1), shift[0], rotation(1, 0), rotation(1, 1),
                         shift[1], rotation(2, 0), rotation(2, 1), shift[2]);
  // The first inner corner is the origin. Pixel i of the drawing covers [i, i + 1] / kSquarePx.
  const double scale = kBoard.square_m / kSquarePx;
  const cv::Matx33d to_board(scale, 0, (0.5 - kSquarePx) * scale, 0, scale,
                             (0.5 - kSquarePx) * scale, 0, 0, 1);
  const cv::Matx33d enlarge(4, 0, 1.5, 0, 4, 1.5, 0, 0, 1);
  cv::Mat large, image;
  cv::warpPerspective(flat, large, enlarge * matrix * pose * to_board, kSize * 4, cv::INTER_LINEAR,
                      cv::BORDER_CONSTANT, cv::Scalar(230));
  cv::resize(large, image, kSize, 0, 0, cv::INTER_AREA);
  return image;
}

TEST(RigCalibration, FindsTheCornersOfADrawnBoard) {
  const KnownRig rig;
  const cv::Vec3d turn(0.2, -0.3, 0.1), shift(-0.1, -0.08, 0.6);
  const auto found = findBoard(drawBoard(rig.left_matrix, turn, shift), kBoard);
  ASSERT_TRUE(found);
  BoardCorners truth;
  cv::projectPoints(kBoard.points(), turn, shift, rig.left_matrix, cv::noArray(), truth);
  ASSERT_EQ(found->size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_LT(cv::norm((*found)[i] - truth[i]), 0.1) << "corner " << i;
  }
}

TEST(RigCalibration, FindsNoBoardWhereNoneIsWhole) {
  const cv::Mat whole = drawBoard(KnownRig().left_matrix, {0, 0, 0}, {-0.1, -0.08, 0.6});
  ASSERT_TRUE(findBoard(whole, kBoard));
  cv::Mat covered = whole.clone();
  covered.colRange(0, kSize.width / 2).setTo(128);
  EXPECT_FALSE(findBoard(covered, kBoard));
  EXPECT_FALSE(findBoard(cv::Mat(kSize, CV_8UC1, cv::Scalar(128)), kBoard));
}

}  // namespace
}  // namespace cbmv
