#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <string>

#include <boost/make_shared.hpp>
#include <boost/shared_ptr.hpp>
#include <ros/datatypes.h>
#include <ros/message_traits.h>
#include <ros/serialization.h>

#include "offline/message_lengths.h"

namespace cbmv {

/// A topic of a bag with its publisher's connection data.
struct BagConnection {
  std::string topic;
  std::string type;
  std::string md5;
  std::string definition;
  boost::shared_ptr<ros::M_string> header;  ///< as recorded (latching, callerid, …); may be null
};

/// A serialized message of any type, accepted by rosbag::Bag::write.
struct RawMessage {
  std::shared_ptr<const BagConnection> connection;
  std::shared_ptr<const void> owner;  ///< keeps the bytes alive
  const std::uint8_t* data = nullptr;
  std::uint32_t size = 0;
};

/// Uninitialized bytes; a std::vector would set them to 0.
inline std::shared_ptr<std::uint8_t> newBytes(std::uint32_t size) {
  return {new std::uint8_t[size], std::default_delete<std::uint8_t[]>()};
}

template <typename Message>
RawMessage toRawMessage(const Message& message, const std::string& topic) {
  namespace traits = ros::message_traits;
  const std::uint32_t size = ros::serialization::serializationLength(message);
  const std::shared_ptr<std::uint8_t> bytes = newBytes(size);
  ros::serialization::OStream stream(bytes.get(), size);
  ros::serialization::serialize(stream, message);
  const BagConnection connection{topic, traits::datatype(message), traits::md5sum(message),
                                 traits::definition(message), nullptr};
  return {std::make_shared<const BagConnection>(connection), bytes, bytes.get(), size};
}

/// Throws ros::serialization::StreamOverrunException if the message is too short. Never allocates
/// more memory than the message has bytes, whatever lengths it claims.
template <typename Message>
boost::shared_ptr<Message> fromRawMessage(const RawMessage& raw) {
  requireLengths<Message>(raw.data, raw.size);
  auto message = boost::make_shared<Message>();
  // IStream has no interface for const bytes, but does not write.
  ros::serialization::IStream stream(const_cast<std::uint8_t*>(raw.data), raw.size);
  ros::serialization::deserialize(stream, *message);
  return message;
}

}  // namespace cbmv

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<cbmv::RawMessage> {
  static const char* value(const cbmv::RawMessage& m) { return m.connection->md5.c_str(); }
};
template <>
struct DataType<cbmv::RawMessage> {
  static const char* value(const cbmv::RawMessage& m) { return m.connection->type.c_str(); }
};
template <>
struct Definition<cbmv::RawMessage> {
  static const char* value(const cbmv::RawMessage& m) { return m.connection->definition.c_str(); }
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<cbmv::RawMessage> {
  template <typename Stream>
  static void write(Stream& stream, const cbmv::RawMessage& m) {
    std::memcpy(stream.advance(m.size), m.data, m.size);
  }
  static std::uint32_t serializedLength(const cbmv::RawMessage& m) { return m.size; }
};

}  // namespace serialization
}  // namespace ros
