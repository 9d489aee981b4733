#include "evaluation/sparsification.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include "evaluation/map_checks.h"

namespace cbmv {
namespace {

constexpr int kSteps = 100;

struct Pixel {
  float confidence;
  bool bad;
};

std::vector<Pixel> countedPixels(const cv::Mat& disparity, const cv::Mat& confidence,
                                 const cv::Mat& truth, const cv::Mat& mask, float invalid,
                                 float bad_px) {
  std::vector<Pixel> pixels;
  forCountedPixels(truth, mask, [&](int y, int x) {
    const float d = disparity.at<float>(y, x);
    const float c = confidence.at<float>(y, x);
    const bool has_d = hasDisparity(d, invalid);
    pixels.push_back({has_d && !std::isnan(c) ? c : -std::numeric_limits<float>::infinity(),
                      !has_d || std::abs(d - truth.at<float>(y, x)) > bad_px});
  });
  return pixels;
}

/// Percent of bad pixels among the k + 1 percent most confident pixels.
std::vector<double> curve(std::vector<Pixel> pixels) {
  std::sort(pixels.begin(), pixels.end(),
            [](const Pixel& a, const Pixel& b) { return a.confidence > b.confidence; });
  std::vector<double> bad_percent;
  double bad_before = 0.0;  // bad pixels before `begin`
  for (std::size_t begin = 0; begin < pixels.size();) {
    std::size_t end = begin;
    double bad = 0.0;
    for (; end < pixels.size() && pixels[end].confidence == pixels[begin].confidence; ++end) {
      bad += pixels[end].bad ? 1.0 : 0.0;
    }
    const double bad_share = bad / static_cast<double>(end - begin);
    while (bad_percent.size() * pixels.size() + pixels.size() <= end * kSteps) {
      const double kept = static_cast<double>((bad_percent.size() + 1) * pixels.size()) / kSteps;
      bad_percent.push_back(100.0 * (bad_before + bad_share * (kept - static_cast<double>(begin))) /
                            kept);
    }
    bad_before += bad;
    begin = end;
  }
  return bad_percent;
}

double area(const std::vector<double>& curve) {
  return std::accumulate(curve.begin(), curve.end(), 0.0) / kSteps;
}

}  // namespace

Sparsification sparsify(const cv::Mat& disparity, const cv::Mat& confidence, const cv::Mat& truth,
                        const cv::Mat& mask, float invalid, float bad_px) {
  requireMap(disparity, "disparity", CV_32FC1, disparity.size());
  requireMap(confidence, "confidence", CV_32FC1, disparity.size());
  requireMap(truth, "truth", CV_32FC1, disparity.size());
  requireMap(mask, "mask", CV_8UC1, disparity.size());
  std::vector<Pixel> pixels = countedPixels(disparity, confidence, truth, mask, invalid, bad_px);
  if (pixels.empty()) {
    return {std::vector<double>(kSteps, 0.0), std::vector<double>(kSteps, 0.0), 0.0, 0.0};
  }
  Sparsification result;
  result.bad = curve(pixels);
  result.auc = area(result.bad);
  for (Pixel& pixel : pixels) {
    pixel.confidence = pixel.bad ? 0.0F : 1.0F;
  }
  result.bad_optimal = curve(pixels);
  result.auc_optimal = area(result.bad_optimal);
  return result;
}

}  // namespace cbmv
