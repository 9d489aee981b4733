#include "ros/stereo_nodelet.h"

#include <algorithm>
#include <exception>
#include <thread>
#include <utility>

#include <opencv2/imgproc.hpp>
#include <pluginlib/class_list_macros.hpp>

#include "ros/parameter_server.h"

#include "cbmv_stereo/forest/forest_file.h"
#include "cbmv_stereo/pipeline/parameters.h"

namespace cbmv {
namespace {

constexpr double kSilencePeriodS = 15;

/// Causes of warnings besides the values of InputFault.
enum Cause { kFailed = 100, kRangeClipped, kColorUnusable };

template <typename Message>
void publishShared(const ros::Publisher& publisher, Message message) {
  publisher.publish(boost::make_shared<Message>(std::move(message)));
}

void publishShared(const image_transport::Publisher& publisher, sensor_msgs::Image message) {
  publisher.publish(
      sensor_msgs::ImageConstPtr(boost::make_shared<sensor_msgs::Image>(std::move(message))));
}

}  // namespace

StereoNodelet::~StereoNodelet() { stop(); }

void StereoNodelet::onInit() {
  try {
    initialize();
  } catch (const std::exception& error) {
    NODELET_FATAL("cannot start: %s", error.what());
    stop();  // nodelet::Loader frees the callback queues before it frees a nodelet that threw
    throw;
  }
}

void StereoNodelet::stop() {
  // First whatever calls back, then the worker that the callbacks feed.
  config_server_.reset();
  silence_timer_.stop();
  color_subscriber_.shutdown();
  inputs_.reset();
  worker_.reset();
}

void StereoNodelet::initialize() {
  ros::NodeHandle& nh = getNodeHandle();
  ros::NodeHandle& private_nh = getPrivateNodeHandle();

  options_ = readOptions();
  threads_ = options_.threads > 0 ? options_.threads
                                  : static_cast<int>(std::thread::hardware_concurrency());
  processor_ = std::make_unique<StereoProcessor>(
      loadForest(), options_, private_nh.param("allow_different_frame_ids", false));
  config_server_ = std::make_unique<dynamic_reconfigure::Server<cbmv_stereo::StereoConfig>>(
      config_mutex_, private_nh);
  config_server_->setCallback(
      [this](cbmv_stereo::StereoConfig& config, std::uint32_t) { reconfigure(config); });
  NODELET_INFO_STREAM("parameters:\n" << describeOptions(options_));

  worker_ = std::make_unique<FrameWorker>([this](const StereoMessages& frame) { work(frame); });
  inputs_ = std::make_unique<StereoInputs>(nh, private_nh,
                                           [this](const StereoMessages& frame) { receive(frame); });
  topics_ = inputs_->topics();
  color_topic_ = nh.resolveName("left/image_rect_color");
  colors_.emplace(static_cast<std::size_t>(inputs_->queueSize()));
  advertise();
  silence_timer_ = nh.createWallTimer(ros::WallDuration(kSilencePeriodS),
                                      [this](const ros::WallTimerEvent&) { reportSilence(); });
}

StereoOptions StereoNodelet::readOptions() {
  ros::NodeHandle& private_nh = getPrivateNodeHandle();
  StereoOptions options;
  const auto preset = private_nh.param<std::string>("preset", "");
  if (!preset.empty()) {
    readPreset(preset, options);
    for (const std::string& difference : offerParameters(options, private_nh)) {
      NODELET_INFO_STREAM(difference << " of the preset " << preset);
    }
  }
  options.threads = private_nh.param("threads", 0);
  if (options.threads < 0) {
    throw Error(private_nh.resolveName("threads") + " is " + std::to_string(options.threads) +
                "; a number of threads, or 0 for all, would be right");
  }
  correctOptions(options);  // reported when the parameter server's values are applied
  return options;
}

std::shared_ptr<const Forest> StereoNodelet::loadForest() {
  ros::NodeHandle& private_nh = getPrivateNodeHandle();
  const auto path = private_nh.param<std::string>("forest", "");
  if (path.empty()) {
    throw Error("the parameter " + private_nh.resolveName("forest") +
                " is not set; the path of a forest file would be right");
  }
  auto forest = std::make_shared<const Forest>(readForest(path));
  forest_name_ = forest->name;
  return forest;
}

void StereoNodelet::advertise() {
  ros::NodeHandle& nh = getNodeHandle();
  transport_ = std::make_unique<image_transport::ImageTransport>(nh);
  const ros::SubscriberStatusCallback changed = [this](const ros::SingleSubscriberPublisher&) {
    updateSubscriptions();
  };
  const image_transport::SubscriberStatusCallback image_changed =
      [this](const image_transport::SingleSubscriberPublisher&) { updateSubscriptions(); };

  // Until all publishers are there, a subscriber that comes at once has to wait.
  const std::lock_guard<std::mutex> lock(subscriptions_mutex_);
  disparity_publisher_ =
      nh.advertise<stereo_msgs::DisparityImage>("disparity", 1, changed, changed);
  points_publisher_ = nh.advertise<sensor_msgs::PointCloud2>("points2", 1, changed, changed);
  status_publisher_ = nh.advertise<cbmv_stereo::Status>("status", 1, changed, changed);
  confidence_publisher_ = transport_->advertise("confidence", 1, image_changed, image_changed);
  disparity_color_publisher_ =
      transport_->advertise("disparity_color", 1, image_changed, image_changed);
}

void StereoNodelet::updateSubscriptions() {
  const std::lock_guard<std::mutex> lock(subscriptions_mutex_);
  if (wantsInput() != inputs_->isSubscribed()) {
    wantsInput() ? inputs_->subscribe() : inputs_->unsubscribe();
  }
  updateColorSubscription();
}

bool StereoNodelet::wantsInput() const {
  return disparity_publisher_.getNumSubscribers() > 0 ||
         points_publisher_.getNumSubscribers() > 0 || status_publisher_.getNumSubscribers() > 0 ||
         confidence_publisher_.getNumSubscribers() > 0 ||
         disparity_color_publisher_.getNumSubscribers() > 0;
}

void StereoNodelet::updateColorSubscription() {
  if (points_publisher_.getNumSubscribers() == 0) {
    color_subscriber_.shutdown();
  } else if (!color_subscriber_) {
    color_subscriber_ = transport_->subscribe(
        "left/image_rect_color", static_cast<std::uint32_t>(inputs_->queueSize()),
        [this](const sensor_msgs::ImageConstPtr& image) { colors_->add(image); }, nullptr,
        image_transport::TransportHints("raw", ros::TransportHints(), getPrivateNodeHandle()));
  }
}

void StereoNodelet::reportSilence() {
  const std::string silence = inputs_->describeSilence();
  if (!silence.empty()) {
    NODELET_WARN_STREAM("in " << kSilencePeriodS << " s, " << silence);
  }
}

void StereoNodelet::reconfigure(cbmv_stereo::StereoConfig& config) {
  StereoOptions wanted = options_;
  try {
    applyConfig(config, wanted);
    for (const std::string& correction : correctOptions(wanted)) {
      NODELET_WARN_STREAM(correction);
    }
    options_ = wanted;
  } catch (const Error& error) {
    NODELET_WARN_STREAM(error.what() << "; all parameters keep their values");
  }
  writeConfig(options_, config);
  processor_->setOptions(options_);
}

void StereoNodelet::receive(const StereoMessages& frame) {
  if (worker_->submit(frame)) {
    ++dropped_busy_;
  }
}

void StereoNodelet::work(const StereoMessages& frame) {
  try {
    const ProcessedFrame processed = processor_->process(frame, topics_);
    ++processed_;
    if (!processed.range_correction.empty()) {
      warn(kRangeClipped, processed.range_correction);
    }
    publish(frame, processed);
  } catch (const InputError& error) {
    ++dropped_bad_input_;
    warn(static_cast<int>(error.fault()), std::string(error.what()) + "; frame dropped");
  } catch (const std::exception& error) {
    ++dropped_failed_;
    warn(kFailed, std::string("frame dropped: ") + error.what());
  }
}

void StereoNodelet::publish(const StereoMessages& frame, const ProcessedFrame& processed) {
  const std_msgs::Header& header = frame.left_image->header;
  const StereoResult& result = processed.result;
  if (disparity_publisher_.getNumSubscribers() > 0) {
    publishShared(disparity_publisher_, toDisparityImage(result, processed.geometry,
                                                         processed.disparity_step_px, header));
  }
  if (points_publisher_.getNumSubscribers() > 0) {
    publishShared(points_publisher_,
                  toPointCloud(result, processed.geometry, colorOf(frame, processed), header));
  }
  if (confidence_publisher_.getNumSubscribers() > 0) {
    publishShared(confidence_publisher_, toConfidenceImage(result, header));
  }
  if (disparity_color_publisher_.getNumSubscribers() > 0) {
    publishShared(disparity_color_publisher_, toDisparityColorImage(result, header));
  }
  if (status_publisher_.getNumSubscribers() > 0) {
    publishShared(status_publisher_, toStatus(result, stateAt(header.stamp), header));
  }
}

cv::Mat StereoNodelet::colorOf(const StereoMessages& frame, const ProcessedFrame& processed) {
  if (const auto image = colors_->find(frame.left_image->header.stamp)) {
    try {
      return toColor(*image, color_topic_, processed.left_grey.size());
    } catch (const InputError& error) {
      warn(kColorUnusable, std::string(error.what()) + "; the cloud stays grey");
    }
  }
  cv::Mat grey;
  cv::cvtColor(processed.left_grey, grey, cv::COLOR_GRAY2BGR);
  return grey;
}

NodeState StereoNodelet::stateAt(const ros::Time& stamp) const {
  NodeState state;
  state.counts = {processed_, dropped_busy_, dropped_bad_input_, dropped_failed_};
  state.forest = forest_name_;
  state.threads = threads_;
  state.age_ms = (ros::Time::now() - stamp).toSec() * 1000;
  return state;
}

void StereoNodelet::warn(int cause, const std::string& sentence) {
  if (throttle_.isDue(cause)) {
    NODELET_WARN_STREAM(sentence);
  }
}

}  // namespace cbmv

PLUGINLIB_EXPORT_CLASS(cbmv::StereoNodelet, nodelet::Nodelet)
