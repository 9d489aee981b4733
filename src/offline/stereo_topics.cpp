#include "offline/stereo_topics.h"

#include <algorithm>
#include <array>
#include <vector>

#include "io/stereo_cameras.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr std::array<const char*, 6> kImageNames = {
    "image_rect", "image_rect/compressed", "image_rect_color", "image_rect_color/compressed",
    "image_raw",  "image_raw/compressed"};
constexpr const char* kCompressedType = "sensor_msgs/CompressedImage";
constexpr const char* kImageType = "sensor_msgs/Image";

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::string parent(const std::string& topic) { return topic.substr(0, topic.rfind('/')); }

bool isImage(const BagSet& bags, const std::string& topic) {
  const std::string type = bags.typeOf(topic);
  return type == kImageType || type == kCompressedType;
}

ImageTopic describeImage(const BagSet& bags, const std::string& topic) {
  const bool compressed = bags.typeOf(topic) == kCompressedType;
  return {topic, compressed, false};
}

/// The last part of the image topic's name, without /compressed.
std::string imageName(const ImageTopic& topic) {
  const std::string image = topic.compressed ? parent(topic.name) : topic.name;
  return image.substr(image.rfind('/') + 1);
}

bool looksRectified(const ImageTopic& topic) {
  return imageName(topic).find("rect") != std::string::npos;
}

/// Decides whether the images are raw, and explains why.
void chooseRectification(const TopicChoice& choice, CameraTopics& topics) {
  const bool by_name = choice.rectified == Rectified::kAuto;
  const bool rectified = by_name ? looksRectified(topics.left) && looksRectified(topics.right)
                                 : choice.rectified == Rectified::kYes;
  topics.left.raw = topics.right.raw = !rectified;
  const std::string images = topics.left.name + " and " + topics.right.name;
  const std::string option = rectified ? "--rectified yes" : "--rectified no";
  const std::string other = rectified ? "to rectify them first, use --rectified no"
                                      : "to use them as they are, use --rectified yes";
  topics.rectification =
      images +
      (rectified ? " are treated as rectified: " : " are treated as raw and rectified first: ") +
      (by_name ? std::string(rectified ? "their names contain" : "not both names contain") +
                     " \"rect\" (" + other + ")"
               : option);
}

/// The namespace of the camera of the images.
std::string cameraOf(const ImageTopic& topic) {
  return parent(topic.compressed ? parent(topic.name) : topic.name);
}

/// The first pair of image topics of a stereo namespace; empty names if there is none.
std::pair<std::string, std::string> imagesIn(const BagSet& bags, const std::string& name) {
  for (const char* image : kImageNames) {
    const std::string left = name + "/left/" + image;
    const std::string right = name + "/right/" + image;
    if (isImage(bags, left) && isImage(bags, right)) {
      return {left, right};
    }
  }
  return {};
}

std::vector<std::string> stereoNamespaces(const BagSet& bags) {
  std::vector<std::string> found;
  for (const std::string& topic : bags.topics()) {
    for (const char* image : kImageNames) {
      const std::string end = std::string("/left/") + image;
      if (endsWith(topic, end)) {
        const std::string name = topic.substr(0, topic.size() - end.size());
        if (!imagesIn(bags, name).first.empty() &&
            std::find(found.begin(), found.end(), name) == found.end()) {
          found.push_back(name);
        }
      }
    }
  }
  return found;
}

Error noTopics(const BagSet& bags, const std::string& problem) {
  return Error(bags.names() + ": " + problem + ". The bag contains:\n" + bags.describeTopics());
}

std::string withoutSlash(std::string name) {
  while (endsWith(name, "/")) {
    name.pop_back();
  }
  return name;
}

/// Bags contain resolved names.
std::string resolved(const std::string& name) {
  return !name.empty() && name.front() != '/' ? "/" + name : name;
}

std::pair<std::string, std::string> chooseImages(const BagSet& bags, const TopicChoice& choice) {
  if (!choice.left.empty() || !choice.right.empty()) {
    const std::pair<std::string, std::string> images = {resolved(choice.left),
                                                        resolved(choice.right)};
    for (const std::string& topic : {images.first, images.second}) {
      if (topic.empty()) {
        throw Error(
            "only one of --left and --right is given, expected both or none. Add the other one");
      }
      if (!isImage(bags, topic)) {
        throw noTopics(bags, "there are no images on " + topic);
      }
    }
    if (images.first == images.second) {
      throw Error("--left and --right are both " + images.first +
                  ", expected the topics of two cameras. Correct one of them.");
    }
    return images;
  }
  if (!choice.camera_namespace.empty()) {
    auto images = imagesIn(bags, resolved(withoutSlash(choice.camera_namespace)));
    if (images.first.empty()) {
      throw noTopics(bags,
                     "no stereo pair below " + resolved(withoutSlash(choice.camera_namespace)));
    }
    return images;
  }
  const std::vector<std::string> names = stereoNamespaces(bags);
  if (names.empty()) {
    throw noTopics(bags,
                   "no stereo pair (left/image_rect and right/image_rect, image_rect_color or "
                   "image_raw, or the same /compressed); give its topics with --left and --right");
  }
  if (names.size() > 1) {
    std::string list;
    for (const std::string& name : names) {
      list += " " + (name.empty() ? "/" : name);
    }
    throw Error(bags.names() +
                ": more than one stereo camera, expected one. Choose one with --namespace:" + list);
  }
  return imagesIn(bags, names.front());
}

std::string findInfo(const BagSet& bags, const ImageTopic& image) {
  std::string topic = cameraOf(image) + "/camera_info";
  if (bags.typeOf(topic) != "sensor_msgs/CameraInfo") {
    throw noTopics(bags, "no calibration for " + image.name + ": " + topic +
                             " is missing. Give files with --left-calibration and "
                             "--right-calibration");
  }
  return topic;
}

/// As in the node: image_rect_color beside the left images. Images with other names are their own
/// color source.
ImageTopic findColor(const BagSet& bags, const ImageTopic& left) {
  if (left.raw || !looksRectified(left)) {
    return left;
  }
  for (const char* name : {"/image_rect_color", "/image_rect_color/compressed"}) {
    const std::string topic = cameraOf(left) + name;
    if (isImage(bags, topic)) {
      return describeImage(bags, topic);
    }
  }
  return {};
}

/// Reads calibration files; for rectified images only P is used.
void takeCalibrations(const TopicChoice& choice, CameraTopics& topics) {
  const StereoCameraFile file =
      readStereoCameras(choice.left_calibration, choice.right_calibration);
  if (file.rectified && topics.left.raw) {
    throw Error(choice.left_calibration + " (" + file.description +
                ") describes rectified images, but " + topics.rectification +
                ". Give the calibration of the raw images, or use --rectified yes.");
  }
  topics.cameras = file.cameras;
  topics.left_info = choice.left_calibration;
  topics.right_info =
      choice.right_calibration.empty() ? choice.left_calibration : choice.right_calibration;
}

}  // namespace

CameraTopics findCameraTopics(const BagSet& bags, const TopicChoice& choice) {
  const auto [left, right] = chooseImages(bags, choice);
  CameraTopics topics;
  topics.left = describeImage(bags, left);
  topics.right = describeImage(bags, right);
  chooseRectification(choice, topics);
  if (!choice.left_calibration.empty()) {
    takeCalibrations(choice, topics);
  } else {
    topics.left_info = findInfo(bags, topics.left);
    topics.right_info = findInfo(bags, topics.right);
  }
  topics.color = findColor(bags, topics.left);
  topics.output_namespace = choice.camera_namespace.empty()
                                ? parent(cameraOf(topics.left))
                                : resolved(withoutSlash(choice.camera_namespace));
  return topics;
}

}  // namespace cbmv
