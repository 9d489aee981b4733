#include "input/stereo_input.h"

#include "input/camera_properties.h"

namespace cbmv {
namespace {

void requireImage(const cv::Mat& image, const std::string& name) {
  if (image.empty()) {
    throw InputError(InputFault::kEmptyImage, name + " has an empty image (" +
                                                  sizeText(image.size()) +
                                                  "), expected at least 1 x 1 px. Check the input");
  }
}

}  // namespace

GrayPair toGrayPair(const StereoInput& input) {
  requireImage(input.left, input.names.left_image);
  requireImage(input.right, input.names.right_image);
  if (input.left.size() != input.right.size()) {
    throw InputError(InputFault::kDifferentSizes,
                     input.names.left_image + " and " + input.names.right_image +
                         " have different sizes (" + sizeText(input.left.size()) + " and " +
                         sizeText(input.right.size()) +
                         "), expected equal sizes. Use a rectified pair");
  }
  return toGrayPair(input.left, input.right);
}

}  // namespace cbmv
