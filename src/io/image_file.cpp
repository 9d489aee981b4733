#include "cbmv_stereo/io/image_file.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "image_decoding.h"

#include "cbmv_stereo/error.h"

namespace cbmv {

cv::Mat readColorImage(const std::string& path) {
  cv::Mat image = decodeImageFile(path, cv::IMREAD_COLOR);
  if (image.empty()) {
    throw Error("Cannot read " + path + ": it is not an image, or damaged, or of a format that " +
                "OpenCV cannot decode.");
  }
  return image;
}

cv::Mat readGreyImage(const std::string& path) {
  // Not IMREAD_GRAYSCALE: there each decoder has weights of its own.
  cv::Mat grey;
  cv::cvtColor(readColorImage(path), grey, cv::COLOR_BGR2GRAY);
  return grey;
}

void writeImage(const std::string& path, const cv::Mat& image) {
  bool written = false;
  try {
    written = cv::imwrite(path, image);
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) {
    throw Error("Cannot write " + path + ": the folder must exist and allow writing, and the " +
                "extension must be one that OpenCV writes, such as .png.");
  }
}

}  // namespace cbmv
