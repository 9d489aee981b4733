#pragma once

#include <memory>
#include <string>
#include <vector>

#include "data_sets/data_set.h"
#include "data_sets/stereo_scene.h"

namespace cbmv {

/// Lists and reads the scenes of one kind of data set.
class SceneReader {
 public:
  virtual ~SceneReader() = default;
  virtual std::vector<std::string> scenes() const = 0;  ///< sorted
  virtual StereoScene read(const std::string& scene) const = 0;
};

// See data_set.h for the layouts and their truth.
std::unique_ptr<SceneReader> makeMiddleburyReader(const std::string& folder, Truth truth);
std::unique_ptr<SceneReader> makeEth3dReader(const std::string& folder, Truth truth);
std::unique_ptr<SceneReader> makeMiddlebury2005Reader(const std::string& folder, Truth truth);
std::unique_ptr<SceneReader> makeMiddlebury2005HalfReader(const std::string& folder, Truth truth);
std::unique_ptr<SceneReader> makeMiddlebury2005FullReader(const std::string& folder, Truth truth);
std::unique_ptr<SceneReader> makeKitti2012Reader(const std::string& folder, Truth truth);
std::unique_ptr<SceneReader> makeKitti2015Reader(const std::string& folder, Truth truth);
std::unique_ptr<SceneReader> makeListReader(const std::string& file, Truth truth);

}  // namespace cbmv
