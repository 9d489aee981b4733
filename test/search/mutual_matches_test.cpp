#include "search/mutual_matches.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#include <tbb/global_control.h>

#include "evaluation/rendered_scene.h"
#include "support/simd_targets.h"

namespace cbmv {
namespace {

constexpr int kHuge = 1 << 20;

int at(const cv::Mat& image, int y, int x) {
  return image.at<uchar>(std::clamp(y, 0, image.rows - 1), std::clamp(x, 0, image.cols - 1));
}

/// The cost of the header, computed with plain loops.
class Reference {
 public:
  Reference(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
            int clear_percent)
      : left_(left), right_(right), range_(range), clear_percent_(clear_percent) {}

  cv::Mat_<std::int16_t> matches() const {
    cv::Mat_<std::int16_t> found(left_.size());
    for (int y = 0; y < left_.rows; ++y) {
      for (int x = 0; x < left_.cols; ++x) {
        found(y, x) = match(y, x);
      }
    }
    return found;
  }

 private:
  bool isInside(int x, int i) const {
    const int match = x - range_.min - i;
    return x >= 0 && x < left_.cols && match >= 0 && match < left_.cols;
  }

  int distance(int y, int x, int i) const {
    const int d = range_.min + i;
    x = std::clamp(x, std::max(0, d), std::min(left_.cols, left_.cols + d) - 1);
    const int match = x - d;
    int bits = 0;
    for (int dy = -3; dy <= 3; ++dy) {
      for (int dx = -4; dx <= 4; ++dx) {
        bits += (at(left_, y + dy, x + dx) < at(left_, y, x)) !=
                (at(right_, y + dy, match + dx) < at(right_, y, match));
      }
    }
    return bits;
  }

  int cost(int y, int x, int i) const {
    if (!isInside(x, i)) {
      return kHuge;
    }
    int sum = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        sum += distance(std::clamp(y + dy, 0, left_.rows - 1), x + dx, i);
      }
    }
    return sum;
  }

  int rightWinner(int y, int x_right) const {
    int best = kHuge;
    int winner = 0;
    for (int i = 0; i < range_.count; ++i) {
      const int c = cost(y, x_right + range_.min + i, i);
      if (c < best) {
        best = c;
        winner = i;
      }
    }
    return winner;
  }

  std::int16_t match(int y, int x) const {
    int winner = -1;
    int best = kHuge;
    for (int i = 0; i < range_.count; ++i) {
      const int c = cost(y, x, i);
      if (c < best) {
        best = c;
        winner = i;
      }
    }
    if (winner < 0) {
      return kNoMatch;
    }
    int second = kHuge;
    for (int i = 0; i < range_.count; ++i) {
      if (std::abs(i - winner) > 1) {
        second = std::min(second, cost(y, x, i));
      }
    }
    const bool mutual = std::abs(rightWinner(y, x - range_.min - winner) - winner) <= 1;
    return mutual && second < kHuge && 100 * best < clear_percent_ * second
               ? static_cast<std::int16_t>(winner)
               : kNoMatch;
  }

  const cv::Mat& left_;
  const cv::Mat& right_;
  const DisparityRange range_;
  const int clear_percent_;
};

struct Case {
  cv::Size size;
  DisparityRange range;
};

void expectReference(MutualMatcher& matcher, const Case& c, int clear_percent = 99) {
  const RenderedScene scene = renderScene(c.size.width, c.size.height, c.size.width);
  cv::Mat found;
  matcher.find(scene.left, scene.right, c.range, found);
  const cv::Mat expected = Reference(scene.left, scene.right, c.range, clear_percent).matches();
  ASSERT_EQ(found.type(), CV_16SC1);
  EXPECT_EQ(cv::countNonZero(found != expected), 0)
      << c.size << " from " << c.range.min << ", " << c.range.count;
}

TEST(MutualMatches, EqualTheReferenceOnEveryInstructionSet) {
  const std::vector<Case> cases = {{{70, 27}, {0, 20}},  {{33, 9}, {-7, 15}}, {{64, 30}, {5, 1}},
                                   {{12, 5}, {-20, 50}}, {{9, 3}, {20, 4}},   {{41, 1}, {0, 12}},
                                   {{97, 26}, {0, 31}}};
  test::onEverySimdTarget([&] {
    MutualMatcher matcher;  // reused for all cases
    for (const Case& c : cases) {
      expectReference(matcher, c);
    }
    MutualMatcher strict(70);
    expectReference(strict, cases.front(), 70);
  });
}

/// A pole that is not visible at a coarse level.
TEST(MutualMatches, FindAThinPole) {
  cv::Mat left(40, 160, CV_8UC1);
  cv::randu(left, 0, 256);
  cv::GaussianBlur(left, left, {3, 3}, 0.8);
  cv::Mat right(left.size(), CV_8UC1);
  const int far = 4;
  const int near = 40;
  for (int y = 0; y < left.rows; ++y) {
    for (int x = 0; x < left.cols; ++x) {
      right.at<uchar>(y, x) = at(left, y, x + far);
    }
  }
  cv::Mat pole(left.rows, 4, CV_8UC1);
  cv::randu(pole, 100, 256);
  pole.copyTo(left(cv::Rect(90, 0, 4, left.rows)));
  pole.copyTo(right(cv::Rect(90 - near, 0, 4, left.rows)));
  cv::Mat matches;
  MutualMatcher().find(left, right, {0, 64}, matches);
  EXPECT_GT(cv::countNonZero(matches(cv::Rect(91, 0, 2, left.rows)) == near), left.rows);
  EXPECT_GT(cv::countNonZero(matches(cv::Rect(100, 0, 50, left.rows)) == far), 45 * left.rows);
}

TEST(MutualMatches, NoneWithoutTexture) {
  const cv::Mat flat(20, 90, CV_8UC1, cv::Scalar(90));
  cv::Mat matches;
  MutualMatcher().find(flat, flat, {0, 32}, matches);
  EXPECT_EQ(cv::countNonZero(matches != kNoMatch), 0);
}

TEST(MutualMatches, DoNotDependOnTheNumberOfThreads) {
  const RenderedScene scene = renderScene(120, 100, 3);
  const auto find = [&](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    cv::Mat matches;
    MutualMatcher().find(scene.left, scene.right, {0, 30}, matches);
    return matches;
  };
  EXPECT_EQ(cv::countNonZero(find(1) != find(4)), 0);
}

}  // namespace
}  // namespace cbmv
