#include "offline/bag_writer.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

/// Calls body() and converts its exceptions to an Error with the file.
template <typename Body>
void nameFile(const std::string& path, const Body& body) {
  errno = 0;
  try {
    body();
  } catch (const ros::Exception& error) {
    throw cannotWrite(path, errno != 0 ? std::strerror(errno) : error.what());
  }
}

}  // namespace

Error cannotWrite(const std::string& path, const std::string& reason) {
  return Error("cannot write " + path + ": " + reason +
               ". Check that the folder exists, is writable and has free space");
}

rosbag::CompressionType compressionOf(const std::string& name) {
  if (name == "none") {
    return rosbag::compression::Uncompressed;
  }
  if (name == "lz4") {
    return rosbag::compression::LZ4;
  }
  if (name == "bz2") {
    return rosbag::compression::BZ2;
  }
  throw Error("unknown compression '" + name +
              "', expected none, lz4 or bz2. Correct --compression");
}

BagWriter::BagWriter(std::string path, rosbag::CompressionType compression)
    : path_(std::move(path)), written_path_(path_ + ".writing") {
  nameFile(written_path_, [&] {
    bag_ = std::make_unique<rosbag::Bag>(written_path_, rosbag::bagmode::Write);
    bag_->setCompression(compression);
  });
}

BagWriter::~BagWriter() {
  if (!bag_) {
    return;
  }
  try {
    bag_->close();
  } catch (const std::exception&) {
    // The destructor of a bag closes it again, which throws again. So the bag is leaked; its file
    // is still removed.
    static_cast<void>(bag_.release());
  }
  std::error_code ignored;
  fs::remove(written_path_, ignored);
}

void BagWriter::write(const RawMessage& message, const ros::Time& time) {
  nameFile(written_path_, [&] {
    bag_->write(message.connection->topic, time, message, message.connection->header);
  });
}

void BagWriter::finish(const std::string& final_name) {
  nameFile(written_path_, [&] { bag_->close(); });
  bag_.reset();
  syncToDisk(written_path_);
  std::error_code failure;
  fs::rename(written_path_, final_name, failure);
  if (failure) {
    throw cannotWrite(final_name, failure.message());
  }
  syncToDisk(fs::absolute(final_name).parent_path().string());
}

void syncToDisk(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    throw cannotWrite(path, std::strerror(errno));
  }
  const bool done = fsync(file) == 0;
  close(file);
  if (!done) {
    throw cannotWrite(path, std::strerror(errno));
  }
}

}  // namespace cbmv
