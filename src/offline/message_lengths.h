#pragma once

#include <cstdint>
#include <cstring>

#include <ros/serialization.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/String.h>

namespace cbmv {

/// Checks the lengths in a serialized message. This is needed because roscpp allocates the claimed
/// size of an array before it checks the size of the message.
class MessageWalker {
 public:
  MessageWalker(const std::uint8_t* data, std::uint64_t size) : data_(data), left_(size) {}

  /// Throws ros::serialization::StreamOverrunException if fewer bytes are left.
  void skip(std::uint64_t bytes) {
    if (bytes > left_) {
      throw ros::serialization::StreamOverrunException("a length exceeds the message");
    }
    data_ += bytes;
    left_ -= bytes;
  }

  /// Skips an array or a string: the number of its elements, then the elements.
  void skipArray(std::uint64_t item_bytes) {
    const std::uint8_t* const place = data_;
    std::uint32_t items = 0;
    skip(sizeof(items));
    std::memcpy(&items, place, sizeof(items));
    skip(items * item_bytes);
  }

  /// std_msgs/Header: seq, stamp and frame_id.
  void skipHeader() {
    skip(4 + 8);
    skipArray(1);
  }

 private:
  const std::uint8_t* data_;
  std::uint64_t left_;
};

inline void walk(MessageWalker& walker, const sensor_msgs::Image* /*type*/) {
  walker.skipHeader();
  walker.skip(4 + 4);   // height, width
  walker.skipArray(1);  // encoding
  walker.skip(1 + 4);   // is_bigendian, step
  walker.skipArray(1);  // data
}

inline void walk(MessageWalker& walker, const sensor_msgs::CompressedImage* /*type*/) {
  walker.skipHeader();
  walker.skipArray(1);  // format
  walker.skipArray(1);  // data
}

inline void walk(MessageWalker& walker, const sensor_msgs::CameraInfo* /*type*/) {
  walker.skipHeader();
  walker.skip(4 + 4);   // height, width
  walker.skipArray(1);  // distortion_model
  walker.skipArray(8);  // D; all following fields have a fixed size
}

inline void walk(MessageWalker& walker, const std_msgs::String* /*type*/) { walker.skipArray(1); }

/// Throws ros::serialization::StreamOverrunException if a length exceeds the message.
template <typename Message>
void requireLengths(const std::uint8_t* data, std::uint64_t size) {
  MessageWalker walker(data, size);
  walk(walker, static_cast<const Message*>(nullptr));
}

}  // namespace cbmv
