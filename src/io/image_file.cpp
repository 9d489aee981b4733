#include "io/image_file.h"

#include <opencv2/imgcodecs.hpp>

#include "io/image_decoding.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

std::string sizeText(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

}  // namespace

cv::Mat readImage(const std::string& path) {
  cv::Mat image = decodeImageFile(
      path, cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION);
  if (image.empty()) {
    throw Error("Cannot read " + path +
                ": OpenCV cannot decode it. It is damaged, has an unknown format or is not an "
                "image. Convert it to PNG.");
  }
  if (image.depth() != CV_8U && image.depth() != CV_16U) {
    throw Error("Cannot read " + path + ": its pixels have the type " +
                cv::typeToString(image.type()) +
                ", expected unsigned 8 or 16 bits per channel. Convert it, for example to PNG.");
  }
  return image;
}

void requireSameSize(const std::filesystem::path& file, const cv::Size& size,
                     const std::filesystem::path& reference, const cv::Size& expected) {
  if (size != expected) {
    throw Error(file.string() + " has " + sizeText(size) + " pixels, expected " +
                sizeText(expected) + " as " + reference.string() +
                ". Use files of the same scene and resolution.");
  }
}

GrayPair readGrayPair(const std::string& left_path, const std::string& right_path) {
  const cv::Mat left = readImage(left_path);
  const cv::Mat right = readImage(right_path);
  requireSameSize(right_path, right.size(), left_path, left.size());
  return toGrayPair(left, right);
}

cv::Mat readGrayImage(const std::string& path) {
  const cv::Mat image = readImage(path);
  return toGrayPair(image, image).left;
}

cv::Mat readColorImage(const std::string& path) { return toColor8(readImage(path)); }

void writeImage(const std::string& path, const cv::Mat& image) {
  bool written = false;
  try {
    written = cv::imwrite(path, image);
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) {
    throw Error("Cannot write " + path +
                ". Check that the folder exists and is writable, and that the extension is a "
                "format that OpenCV writes, such as .png.");
  }
}

}  // namespace cbmv
