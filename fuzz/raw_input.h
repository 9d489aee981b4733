#pragma once

#include "fuzz_target.h"
#include "offline/raw_message.h"

namespace cbmv::fuzz {

/// The bytes as a message; null if they are too short for one.
template <typename Message>
boost::shared_ptr<Message> toRosMessage(const std::uint8_t* data, std::size_t size) {
  RawMessage raw;
  raw.data = data;
  raw.size = static_cast<std::uint32_t>(size);
  try {
    return fromRawMessage<Message>(raw);
  } catch (const ros::serialization::StreamOverrunException&) {
    return nullptr;
  }
}

}  // namespace cbmv::fuzz
