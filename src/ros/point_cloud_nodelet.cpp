#include "ros/point_cloud_nodelet.h"

#include <cmath>
#include <exception>

#include <boost/make_shared.hpp>
#include <pluginlib/class_list_macros.hpp>

#include "ros/cloud_parameters.h"
#include "ros/conversions.h"
#include "ros/guarded.h"
#include "ros/unknown_parameters.h"

namespace cbmv {
namespace {

constexpr double kWatchPeriodS = 0.25;
/// Causes of warnings in addition to InputFault.
enum Cause { kFailed = 100, kColorUnusable, kWrongStamps };

/// Uses f and T of the message for Z = f T / d; if they are invalid, those of the calibration
/// remain.
void takeFocalLengthAndBaseline(const stereo_msgs::DisparityImage& disparity,
                                StereoGeometry& geometry) {
  if (std::isfinite(disparity.f) && std::isfinite(disparity.T) && disparity.f > 0 &&
      disparity.T > 0) {
    geometry.focal_length_px = disparity.f;
    geometry.baseline_m = disparity.T;
  }
}

}  // namespace

PointCloudNodelet::~PointCloudNodelet() { stop(); }

void PointCloudNodelet::onInit() {
  acceptCallbacks(getSTCallbackQueue());
  startNodelet(
      getName(), [this] { initialize(); }, [this] { stop(); });
}

void PointCloudNodelet::initialize() {
  const PrivateParameters parameters(getPrivateNodeHandle(), pointCloudPrivateParameters());
  options_ = readCloudOptions(parameters);
  for (const std::string& message :
       describeUnknownParameters(getPrivateNodeHandle(), namesOf(pointCloudPrivateParameters()))) {
    NODELET_WARN_STREAM(message);
  }
  worker_ = std::make_unique<FrameWorker<CloudMessages>>(
      [this](const CloudMessages& messages) { work(messages); });
  const ros::SubscriberStatusCallback changed = [this](const ros::SingleSubscriberPublisher&) {
    guarded(getName(), [this] { updateSubscriptions(); });
  };
  // Makes an early subscriber wait until the publisher exists.
  const std::lock_guard<std::mutex> lock(subscriptions_mutex_);
  inputs_ = std::make_unique<CloudInputs>(
      getNodeHandle(), parameters,
      TopicNames{kCloudInputTopics[0], kCloudInputTopics[1], kCloudInputTopics[2],
                 kCloudInputTopics[3]},
      [this](const auto&... messages) { worker_->submit({messages...}); });
  topics_ = inputs_->topics();
  publisher_ = getNodeHandle().advertise<sensor_msgs::PointCloud2>("points2", 1, changed, changed);
  silence_timer_ = getNodeHandle().createWallTimer(
      ros::WallDuration(kWatchPeriodS),
      [this](const ros::WallTimerEvent&) { guarded(getName(), [this] { reportInputs(); }); });
}

void PointCloudNodelet::stop() {
  {
    const std::lock_guard<std::mutex> lock(subscriptions_mutex_);
    stopping_ = true;
  }
  // Stops first whatever calls back, then the worker. Does not hold the mutex: the destructor of a
  // publisher waits for its callbacks.
  silence_timer_.stop();
  inputs_.reset();
  worker_.reset();
  publisher_.shutdown();
}

void PointCloudNodelet::updateSubscriptions() {
  const std::lock_guard<std::mutex> lock(subscriptions_mutex_);
  const bool wanted = publisher_.getNumSubscribers() > 0;
  if (stopping_ || wanted == inputs_->isSubscribed()) {
    return;
  }
  try {
    wanted ? inputs_->subscribe() : inputs_->unsubscribe();
  } catch (const image_transport::Exception& error) {
    NODELET_ERROR_STREAM("cannot subscribe to images with image_transport '"
                         << inputs_->hints().getTransport() << "': " << error.what()
                         << ". Install the transport plugin, or set image_transport to raw");
  }
}

void PointCloudNodelet::reportInputs() {
  inputs_->handOverIfOverdue();
  const std::string silence = inputs_->reportSilence();
  if (!silence.empty()) {
    NODELET_WARN_STREAM(silence);
  }
  const std::string stamps = inputs_->reportStamps();
  if (!stamps.empty()) {
    warn(kWrongStamps, stamps);
  }
}

void PointCloudNodelet::work(const CloudMessages& messages) {
  try {
    publisher_.publish(boost::make_shared<sensor_msgs::PointCloud2>(makeCloud(messages)));
  } catch (const InputError& error) {
    warn(static_cast<int>(error.fault()), std::string("frame dropped: ") + error.what());
  } catch (const std::exception& error) {
    warn(kFailed, std::string("frame dropped: ") + error.what());
  }
}

sensor_msgs::PointCloud2 PointCloudNodelet::makeCloud(const CloudMessages& messages) {
  const cv::Mat disparity = toValidDisparity(*messages.disparity, topics_[kSecond]);
  const std::string& color_topic = topics_[kFirst];
  StereoGeometry geometry =
      toGeometry(*messages.left_info, *messages.right_info, disparity.size(),
                 {color_topic, topics_[kFirstInfo], color_topic, topics_[kSecondInfo]});
  takeFocalLengthAndBaseline(*messages.disparity, geometry);
  return toPointCloud({disparity, colorOf(messages, disparity.size()), {}, {}}, geometry, options_,
                      messages.disparity->header);
}

cv::Mat PointCloudNodelet::colorOf(const CloudMessages& messages, cv::Size size) {
  const cv::Mat white(size, CV_8UC1, cv::Scalar(255));
  return toCloudColor(messages.color, topics_[kFirst], white, [this](const std::string& reason) {
    warn(kColorUnusable, "the point cloud is published in white: " + reason);
  });
}

void PointCloudNodelet::warn(int cause, const std::string& message) {
  if (throttle_.isDue(cause)) {
    NODELET_WARN_STREAM(message);
  }
}

}  // namespace cbmv

PLUGINLIB_EXPORT_CLASS(cbmv::PointCloudNodelet, nodelet::Nodelet)
