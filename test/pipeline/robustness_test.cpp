// Guarantees of the matcher for arbitrary images: maps have the right size, values are in the range
// or invalid, and the result does not depend on earlier frames, the number of threads or the
// content of memory. scripts/test --sanitize memcheck also runs this test, under valgrind.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>

#include "forest/forest_file.h"
#include "support/random_forest.h"
#include "support/random_images.h"

#include "cbmv_stereo/parameters.h"
#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv::test {
namespace {

/// Fills memory from malloc and memory passed to free with a pattern, so that results that depend
/// on uninitialized memory change with the pattern. Otherwise large blocks come zeroed from the
/// system, which hides such reads.
class PoisonedHeap {
 public:
  explicit PoisonedHeap(int pattern) {
    mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the maximum, so that all blocks are reused
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
    mallopt(M_PERTURB, pattern);
  }
  ~PoisonedHeap() { mallopt(M_PERTURB, 0); }
  PoisonedHeap(const PoisonedHeap&) = delete;
  PoisonedHeap& operator=(const PoisonedHeap&) = delete;
};

struct Pair {
  std::string name;
  cv::Mat left;
  cv::Mat right;
};

std::ostream& operator<<(std::ostream& out, const Pair& pair) {
  return out << pair.name << ", " << pair.left.cols << "x" << pair.left.rows;
}

cv::Mat constant(const cv::Size& size, int gray) {
  return cv::Mat(size, CV_8UC1, cv::Scalar(gray));
}

cv::Mat stripes(const cv::Size& size, int period) {
  cv::Mat image(size, CV_8UC1);
  for (int x = 0; x < size.width; ++x) {
    image.col(x).setTo(x % period < period / 2 ? 0 : 255);
  }
  return image;
}

std::vector<Pair> pairsOf(const cv::Size& size) {
  const cv::Mat noise = makeGray(size, Content::kNoise, 1);
  const cv::Mat other_noise = makeGray(size, Content::kNoise, 2);
  return {{"black", constant(size, 0), constant(size, 0)},
          {"saturated", constant(size, 255), constant(size, 255)},
          {"constant", constant(size, 100), constant(size, 101)},
          {"black and saturated", constant(size, 0), constant(size, 255)},
          {"noise", noise, other_noise},
          {"identical noise", noise, noise},
          {"black and noise", constant(size, 0), noise},
          {"stripes", stripes(size, 8), stripes(size, 8)},
          {"patches", makeGray(size, Content::kPatches, 3), makeGray(size, Content::kPatches, 4)}};
}

StereoOptions optionsFor(const DisparityRange& range, int threads) {
  StereoOptions options;
  options.range = range;
  options.threads = threads;
  return options;
}

std::shared_ptr<const Forest> obliviousForest() {
  return std::make_shared<Forest>(makeForest(8, 5, 3));
}

std::shared_ptr<const Forest> shippedForest() {
  return std::make_shared<Forest>(readForest(CBMV_SOURCE_DIR "/models/middlebury.forest"));
}

/// Expects disparities in the range or invalid, confidences in [0, 1] and valid labels.
void expectDocumentedContent(const StereoResult& result, const cv::Size& size,
                             const DisparityRange& range) {
  ASSERT_EQ(result.disparity.size(), size);
  ASSERT_EQ(result.confidence.size(), size);
  ASSERT_EQ(result.labels.size(), size);
  ASSERT_EQ(result.margin.size(), size);
  ASSERT_EQ(result.disparity.type(), CV_32FC1);
  ASSERT_EQ(result.confidence.type(), CV_32FC1);
  ASSERT_EQ(result.labels.type(), CV_8UC1);
  ASSERT_EQ(result.margin.type(), CV_16UC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const float d = result.disparity.at<float>(y, x);
      const float confidence = result.confidence.at<float>(y, x);
      ASSERT_TRUE(d == range.invalid() || (d >= static_cast<float>(range.min) - 0.5F &&
                                           d <= static_cast<float>(range.max()) + 0.5F))
          << d << " at " << x << ", " << y;
      ASSERT_TRUE(confidence >= 0.0F && confidence <= 1.0F) << confidence;
      ASSERT_LE(result.labels.at<std::uint8_t>(y, x), kOcclusion);
    }
  }
}

bool sameBits(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         (a.empty() || cv::countNonZero(a.reshape(1) != b.reshape(1)) == 0);
}

void expectSameBits(const StereoResult& a, const StereoResult& b) {
  EXPECT_TRUE(sameBits(a.disparity, b.disparity));
  EXPECT_TRUE(sameBits(a.right_disparity, b.right_disparity));
  EXPECT_TRUE(sameBits(a.labels, b.labels));
  EXPECT_TRUE(sameBits(a.confidence, b.confidence));
  EXPECT_TRUE(sameBits(a.margin, b.margin));
}

struct Geometry {
  cv::Size size;
  DisparityRange range;
};

/// Single pixels, rows and columns; ranges wider than the image, outside it and below zero; sizes
/// for which surfaces are computed.
const std::vector<Geometry> kGeometries = {
    {{1, 1}, {0, 64}},    {{64, 1}, {0, 16}},   {{1, 64}, {0, 16}},
    {{7, 40}, {0, 64}},   {{33, 9}, {100, 16}}, {{33, 9}, {-2048, 3}},
    {{61, 47}, {-8, 24}}, {{8, 8}, {2040, 8}},  {{131, 129}, {-3, 20}},
};

TEST(Robustness, AnyImagesGiveTheDocumentedContent) {
  StereoMatcher matcher(shippedForest(), optionsFor({0, 1}, 2));
  for (const Geometry& geometry : kGeometries) {
    matcher.setOptions(optionsFor(geometry.range, 2));
    for (const Pair& pair : pairsOf(geometry.size)) {
      SCOPED_TRACE(testing::Message() << pair << ", disparities from " << geometry.range.min << ", "
                                      << geometry.range.count);
      expectDocumentedContent(matcher.match(pair.left, pair.right), geometry.size, geometry.range);
    }
  }
}

/// Wider than any camera, and too wide for 16-bit differences of squares.
TEST(Robustness, AStripMayBe8192Wide) {
  const DisparityRange range{0, 20};
  StereoMatcher matcher(obliviousForest(), optionsFor(range, 2));
  for (const cv::Size size : {cv::Size(8192, 3), cv::Size(3, 8192)}) {
    for (const Pair& pair : pairsOf(size)) {
      SCOPED_TRACE(pair);
      expectDocumentedContent(matcher.match(pair.left, pair.right), size, range);
    }
  }
}

/// Sets each parameter to its extremes, one at a time.
TEST(Robustness, ExtremeParametersGiveTheDocumentedContent) {
  const cv::Size size(67, 41);
  const DisparityRange range{-2, 19};
  for (const Parameter& parameter : stereoParameters()) {
    const bool is_range = parameter.name == "min_disparity" || parameter.name == "disparity_range";
    if (is_range || parameter.name == "max_memory_mb") {
      continue;
    }
    for (const double extreme : {parameter.lowest, parameter.highest}) {
      SCOPED_TRACE(parameter.name + " " + std::to_string(extreme));
      StereoOptions options = optionsFor(range, 2);
      if (std::holds_alternative<bool>(parameter.default_value)) {
        parameter.set(options, extreme != 0);
      } else if (std::holds_alternative<int>(parameter.default_value)) {
        parameter.set(options, static_cast<int>(extreme));
      } else {
        parameter.set(options, extreme);
      }
      correctOptions(options);
      StereoMatcher matcher(obliviousForest(), options);
      for (const Content content : {Content::kNoise, Content::kPatches}) {
        expectDocumentedContent(
            matcher.match(makeGray(size, content, 5), makeGray(size, content, 6)), size, range);
      }
    }
  }
}

/// The results of all pairs in order, with a new matcher and a heap filled with `pattern`.
std::vector<StereoResult> resultsIn(int pattern, int threads, const std::vector<Pair>& pairs,
                                    const DisparityRange& range) {
  const PoisonedHeap heap(pattern);
  StereoMatcher matcher(obliviousForest(), optionsFor(range, threads));
  std::vector<StereoResult> results;
  results.reserve(pairs.size());
  for (const Pair& pair : pairs) {
    results.push_back(matcher.match(pair.left, pair.right));
  }
  return results;
}

/// Pairs of all sizes, so that every buffer shrinks and grows.
std::vector<Pair> mixedPairs() {
  std::vector<Pair> pairs;
  for (const cv::Size size :
       {cv::Size(150, 140), cv::Size(31, 17), cv::Size(1, 1), cv::Size(97, 61)}) {
    const std::vector<Pair> all = pairsOf(size);
    for (const std::size_t index : {4U, 7U, 8U}) {
      pairs.push_back(all[index]);
    }
  }
  return pairs;
}

TEST(Robustness, BitsDoNotDependOnRunsThreadsEarlierFramesNorOldMemory) {
  const DisparityRange range{-3, 22};
  const std::vector<Pair> pairs = mixedPairs();
  std::vector<StereoResult> expected;
  for (const Pair& pair : pairs) {  // each with a new matcher
    StereoMatcher matcher(obliviousForest(), optionsFor(range, 1));
    expected.push_back(matcher.match(pair.left, pair.right));
  }
  // malloc fills with the complement, free with the pattern. As float these are small, huge,
  // negative huge, zero and NaN.
  for (const auto& [pattern, threads] :
       {std::pair{0x32, 1}, std::pair{0x80, 2}, std::pair{0x01, 3}, std::pair{0xff, 7}}) {
    const std::vector<StereoResult> results = resultsIn(pattern, threads, pairs, range);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      SCOPED_TRACE(testing::Message()
                   << pairs[i] << ", " << threads << " threads, memory of " << pattern);
      expectSameBits(results[i], expected[i]);
    }
  }
}

/// Checks that the pattern is used. Otherwise the test above could not fail.
TEST(Robustness, HeapIsPoisoned) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizers bring their own malloc, with patterns of their own";
#endif
  if (std::getenv("CBMV_MEMCHECK") != nullptr) {
    GTEST_SKIP() << "valgrind brings its own malloc";
  }
  const PoisonedHeap heap(0xcd);
  constexpr std::size_t bytes = 3 << 20;
  const std::unique_ptr<std::uint8_t[]> block(new std::uint8_t[bytes]);
  for (std::size_t i = 64; i < bytes; i += 4096) {
    ASSERT_EQ(block[i], 0xcd ^ 0xff);
  }
}

}  // namespace
}  // namespace cbmv::test
