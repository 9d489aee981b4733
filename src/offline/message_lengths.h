#pragma once

#include <cstdint>
#include <cstring>

#include <ros/serialization.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/String.h>

namespace cbmv {

/// Walks over a serialised message. roscpp takes the memory that an array claims to need before it
/// looks whether the message is that long.
class MessageWalker {
 public:
  MessageWalker(const std::uint8_t* data, std::uint64_t size) : data_(data), left_(size) {}

  /// Throws ros::serialization::StreamOverrunException if there are not as many bytes.
  void skip(std::uint64_t bytes) {
    if (bytes > left_) {
      throw ros::serialization::StreamOverrunException("a length exceeds the message");
    }
    data_ += bytes;
    left_ -= bytes;
  }

  /// An array or a text: the number of its items, then these.
  void skipArray(std::uint64_t item_bytes) {
    const std::uint8_t* const place = data_;
    std::uint32_t items = 0;
    skip(sizeof(items));
    std::memcpy(&items, place, sizeof(items));
    skip(items * item_bytes);
  }

  /// std_msgs/Header: number, stamp and frame.
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
  walker.skipArray(8);  // D; what follows has a fixed size
}

inline void walk(MessageWalker& walker, const std_msgs::String* /*type*/) { walker.skipArray(1); }

/// Throws ros::serialization::StreamOverrunException if a length in the message exceeds its bytes.
template <typename Message>
void requireLengths(const std::uint8_t* data, std::uint64_t size) {
  MessageWalker walker(data, size);
  walk(walker, static_cast<const Message*>(nullptr));
}

}  // namespace cbmv
