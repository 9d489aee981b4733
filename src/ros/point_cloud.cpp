#include "ros/point_cloud.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <sensor_msgs/point_cloud2_iterator.h>

#include "cbmv_stereo/points.h"

namespace cbmv {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Byte offsets of the fields of a point.
struct Layout {
  std::uint32_t rgb;
  std::uint32_t confidence;
  std::uint32_t sigma;
  std::uint32_t point_step;
};

/// PCL's point types are padded to 32 bytes.
Layout layoutOf(const CloudOptions& options) {
  if (!options.compact) {
    return {16, 20, 24, 32};
  }
  const std::uint32_t sigma = options.with_confidence ? 20 : 16;
  return {12, 16, sigma, options.with_sigma ? sigma + 4 : sigma};
}

void addField(const char* name, std::uint32_t offset, sensor_msgs::PointCloud2& cloud) {
  sensor_msgs::PointField field;
  field.name = name;
  field.offset = offset;
  field.datatype = sensor_msgs::PointField::FLOAT32;
  field.count = 1;
  cloud.fields.push_back(field);
}

sensor_msgs::PointCloud2 makeCloud(cv::Size size, const CloudOptions& options,
                                   const std_msgs::Header& header) {
  const Layout layout = layoutOf(options);
  sensor_msgs::PointCloud2 cloud;
  cloud.header = header;
  addField("x", 0, cloud);
  addField("y", 4, cloud);
  addField("z", 8, cloud);
  addField("rgb", layout.rgb, cloud);
  if (options.with_confidence) {
    addField("confidence", layout.confidence, cloud);
  }
  if (options.with_sigma) {
    addField("sigma", layout.sigma, cloud);
  }
  cloud.width = static_cast<std::uint32_t>(size.width);
  cloud.height = static_cast<std::uint32_t>(size.height);
  cloud.point_step = layout.point_step;
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.data.resize(static_cast<std::size_t>(cloud.row_step) * cloud.height);
  cloud.is_bigendian = 0;
  cloud.is_dense = 0;
  return cloud;
}

bool isInside(double z, const CloudOptions& options) {
  return z >= options.min_depth_m && (options.max_depth_m == 0 || z <= options.max_depth_m);
}

/// Point of pixel (x, y) in meters; NaN if it has no disparity or is outside the limits.
cv::Vec3f toPointInside(const StereoGeometry& geometry, const CloudOptions& options, int x, int y,
                        float disparity_px) {
  const cv::Vec3f point = toPoint(geometry, x, y, disparity_px);
  return isInside(point[2], options) ? point : cv::Vec3f::all(kNone);
}

/// Standard deviation of pixel (x, y) with the point `point`.
float sigmaOf(const CloudSource& source, const cv::Vec3f& point, int x, int y) {
  const bool is_known = !source.depth_sigma.empty() && !std::isnan(point[2]);
  return is_known ? source.depth_sigma.at<float>(y, x) : kNone;
}

}  // namespace

sensor_msgs::PointCloud2 toPointCloud(const CloudSource& source, const StereoGeometry& geometry,
                                      const CloudOptions& options, const std_msgs::Header& header) {
  const cv::Size size = source.disparity.size();
  const Layout layout = layoutOf(options);
  sensor_msgs::PointCloud2 cloud = makeCloud(size, options, header);
  std::uint8_t* bytes = cloud.data.data();
  for (int y = 0; y < size.height; ++y) {
    const auto* disparity = source.disparity.ptr<float>(y);
    const auto* color = source.color.ptr<cv::Vec3b>(y);
    for (int x = 0; x < size.width; ++x, bytes += layout.point_step) {
      const cv::Vec3f point = toPointInside(geometry, options, x, y, disparity[x]);
      std::memcpy(bytes, point.val, sizeof(point.val));
      std::memcpy(bytes + layout.rgb, color[x].val, sizeof(color[x].val));
      if (options.with_confidence) {
        std::memcpy(bytes + layout.confidence, source.confidence.ptr<float>(y, x), sizeof(float));
      }
      if (options.with_sigma) {
        const float sigma = sigmaOf(source, point, x, y);
        std::memcpy(bytes + layout.sigma, &sigma, sizeof(sigma));
      }
    }
  }
  return cloud;
}

std::vector<ColoredPoint> fromPointCloud(const sensor_msgs::PointCloud2& message) {
  std::vector<ColoredPoint> points;
  sensor_msgs::PointCloud2ConstIterator<float> point(message, "x");
  sensor_msgs::PointCloud2ConstIterator<std::uint8_t> color(message, "rgb");
  for (; point != point.end(); ++point, ++color) {
    if (std::isfinite(point[2])) {
      points.push_back({point[0], point[1], point[2], color[2], color[1], color[0]});
    }
  }
  return points;
}

}  // namespace cbmv
