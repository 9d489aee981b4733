#include "ros/stereo_nodelet.h"

#include <algorithm>
#include <exception>
#include <thread>
#include <utility>

#include <pluginlib/class_list_macros.hpp>

#include "forest/forest_file.h"
#include "ros/cloud_parameters.h"
#include "ros/guarded.h"
#include "ros/parameter_server.h"
#include "ros/stamps.h"

#include "cbmv_stereo/parameters.h"

namespace cbmv {
namespace {

constexpr double kWatchPeriodS = 0.25;
constexpr std::chrono::milliseconds kColorPatience(50);  // color is rectified after gray

/// Causes of warnings in addition to InputFault.
enum Cause {
  kFailed = 100,
  kRangeClipped,
  kColorUnusable,
  kVerticalOffset,
  kWrongStamps,
  kDoubtfulInput
};

StereoTopics toTopics(const TopicNames& names) {
  return {names[kFirst], names[kFirstInfo], names[kSecond], names[kSecondInfo]};
}

}  // namespace

StereoNodelet::~StereoNodelet() { stop(); }

void StereoNodelet::onInit() {
  acceptCallbacks(getSTCallbackQueue());
  startNodelet(
      getName(), [this] { initialize(); }, [this] { stop(); });
}

void StereoNodelet::stop() {
  {
    const std::lock_guard<std::mutex> lock(subscriptions_mutex_);
    stopping_ = true;
    color_subscriber_.shutdown();
  }
  // Stops first whatever calls back, then the worker. Does not hold the mutex: the destructor of a
  // publisher waits for its callbacks.
  config_server_.reset();
  watch_timer_.stop();
  inputs_.reset();
  worker_.reset();
  outputs_.reset();
  updater_.reset();
}

void StereoNodelet::initialize() {
  const PrivateParameters parameters(getPrivateNodeHandle(), stereoPrivateParameters());
  options_ = readOptions(parameters);
  threads_ = options_.threads > 0 ? options_.threads
                                  : static_cast<int>(std::thread::hardware_concurrency());
  allow_different_frame_ids_ = parameters.get<bool>("allow_different_frame_ids");
  processor_ = std::make_unique<FrameProcessor>(readForestParameter(parameters), options_);
  openDiagnostics(parameters);
  offerConfig(parameters);
  worker_ = std::make_unique<FrameWorker<StereoMessages>>(
      [this](const StereoMessages& frame) { work(frame); });
  openTopics(parameters);
  watch_timer_ = getNodeHandle().createWallTimer(
      ros::WallDuration(kWatchPeriodS),
      [this](const ros::WallTimerEvent&) { guarded(getName(), [this] { watch(); }); });
}

StereoOptions StereoNodelet::readOptions(const PrivateParameters& parameters) {
  StereoOptions options;
  preset_ = parameters.get<std::string>("preset");
  applyPreset(preset_, options);
  if (!presetPath(preset_).empty()) {
    for (const std::string& difference : offerParameters(options, getPrivateNodeHandle())) {
      NODELET_INFO_STREAM(difference << " of the preset " << preset_);
    }
  }
  options.threads = parameters.get<int>("threads");
  correctOptions(
      options);  // corrections are reported when the parameter server's values are applied
  return options;
}

std::shared_ptr<const Forest> StereoNodelet::readForestParameter(
    const PrivateParameters& parameters) {
  const auto path = parameters.get<std::string>("forest");
  if (path.empty()) {
    throw Error("the parameter " + getPrivateNodeHandle().resolveName("forest") +
                " is not set, expected the path of a forest file. Set it, for example to "
                "models/middlebury_small.forest of this package");
  }
  auto forest = cbmv::loadForest(path);
  forest_name_ = forest->name;
  return forest;
}

void StereoNodelet::offerConfig(const PrivateParameters& parameters) {
  for (const std::string& message : describeForeignParameters(getPrivateNodeHandle())) {
    NODELET_WARN_STREAM(message);
  }
  for (const std::string& message : describeUnknownNames(
           getPrivateNodeHandle(), parameters.get<std::string>("unknown_arguments"))) {
    NODELET_WARN_STREAM(message);
  }
  config_server_ = std::make_unique<dynamic_reconfigure::Server<cbmv_stereo::StereoConfig>>(
      config_mutex_, getPrivateNodeHandle());
  config_server_->setCallback(
      [this](cbmv_stereo::StereoConfig& config, std::uint32_t) { reconfigure(config); });
  NODELET_INFO_STREAM("parameters:\n" << describeOptions(options_));
}

void StereoNodelet::openDiagnostics(const PrivateParameters& parameters) {
  const DiagnosticsLimits limits{parameters.get<double>("warn_silence_s"),
                                 parameters.get<double>("warn_age_s"),
                                 parameters.get<double>("warn_vertical_offset_px")};
  diagnostics_ = std::make_unique<StereoDiagnostics>(limits, forest_name_, threads_);
  updater_ = std::make_unique<diagnostic_updater::Updater>(getNodeHandle(), getPrivateNodeHandle(),
                                                           getName());
  updater_->setHardwareID("none");
  diagnostics_->addTo(*updater_);
}

void StereoNodelet::openTopics(const PrivateParameters& parameters) {
  const ros::NodeHandle& nh = getNodeHandle();
  CloudOptions cloud_options = readCloudOptions(parameters);
  cloud_options.with_confidence = parameters.get<bool>("points_confidence");
  cloud_options.with_sigma = parameters.get<bool>("points_sigma");

  // Makes an early subscriber wait until all outputs exist.
  const std::lock_guard<std::mutex> lock(subscriptions_mutex_);
  inputs_ =
      std::make_unique<StereoInputs>(nh, parameters, stereoInputNames(nh, parameters),
                                     [this](const auto&... messages) { receive({messages...}); });
  topics_ = toTopics(inputs_->topics());
  color_name_ = colorInputName(nh, parameters);
  color_topic_ = nh.resolveName(color_name_);
  color_transport_ = std::make_unique<image_transport::ImageTransport>(nh);
  colors_.emplace(static_cast<std::size_t>(inputs_->options().queue_size));
  outputs_ = std::make_unique<OutputPublishers>(nh, stereoOutputs(cloud_options), [this] {
    guarded(getName(), [this] { updateSubscriptions(); });
  });
}

void StereoNodelet::updateSubscriptions() {
  const std::lock_guard<std::mutex> lock(subscriptions_mutex_);
  if (stopping_ || !outputs_) {
    return;
  }
  try {
    if (outputs_->anyIsWanted() != inputs_->isSubscribed()) {
      inputs_->isSubscribed() ? inputs_->unsubscribe() : inputs_->subscribe();
      diagnostics_->setWanted(inputs_->isSubscribed(), ros::SteadyTime::now());
    }
    updateColorSubscription();
  } catch (const image_transport::Exception& error) {
    NODELET_ERROR_STREAM("cannot subscribe to images with image_transport '"
                         << inputs_->hints().getTransport() << "': " << error.what()
                         << ". Install the transport plugin, or set image_transport to raw");
  }
}

void StereoNodelet::updateColorSubscription() {
  if (!outputs_->isWanted("points2")) {
    color_subscriber_.shutdown();
  } else if (!color_subscriber_) {
    colors_->clear();
    color_subscriber_ = color_transport_->subscribe(
        nameToSubscribe(getNodeHandle(), color_name_),
        static_cast<std::uint32_t>(inputs_->options().queue_size),
        [this](const sensor_msgs::ImageConstPtr& image) {
          guarded(getName(), [&] { colors_->add(image); });
        },
        nullptr, inputs_->hints());
  }
}

void StereoNodelet::watch() {
  reportInputs();
  // update() would use ROS time, which can stop or jump back when a bag is played.
  const ros::SteadyTime now = ros::SteadyTime::now();
  if ((now - last_update_).toSec() >= updater_->getPeriod()) {
    last_update_ = now;
    updater_->force_update();
  }
}

void StereoNodelet::reportInputs() {
  inputs_->handOverIfOverdue();
  const std::string silence = inputs_->reportSilence();
  if (!silence.empty()) {
    diagnostics_->silent(silence);
    NODELET_WARN_STREAM(silence);
  }
  const std::string stamps = inputs_->reportStamps();
  if (!stamps.empty()) {
    diagnostics_->stampsAreWrong(stamps, ros::SteadyTime::now());
    warn(kWrongStamps, stamps);
  }
}

void StereoNodelet::reconfigure(cbmv_stereo::StereoConfig& config) {
  try {
    StereoOptions wanted = optionsOf(config);
    min_confidence_ = minConfidence(config);
    for (const std::string& correction : correctOptions(wanted)) {
      reportParameters(correction);
    }
    options_ = wanted;
    preset_ = presetOf(config.preset, options_);
  } catch (const Error& error) {
    reportParameters(std::string(error.what()) + ". All parameters keep their values");
    config.min_confidence = min_confidence_;
  }
  config.preset = preset_;
  writeConfig(options_, config);
  processor_->setOptions(options_);
  processor_->setMinConfidence(min_confidence_);
}

void StereoNodelet::reportParameters(const std::string& message) {
  NODELET_WARN_STREAM(message);
  diagnostics_->parametersDiffer(message);
}

/// A newly selected preset overrides the other values; an unchanged one does not.
StereoOptions StereoNodelet::optionsOf(const cbmv_stereo::StereoConfig& config) const {
  StereoOptions options = options_;
  applyConfig(config, options);
  if (config.preset != preset_) {
    applyPreset(config.preset, options);
  }
  return options;
}

void StereoNodelet::receive(const StereoMessages& frame) {
  diagnostics_->received(ros::SteadyTime::now());
  if (worker_->submit(frame)) {
    diagnostics_->dropped(FrameDrop::kBusy, {}, ros::SteadyTime::now());
  }
}

void StereoNodelet::work(const StereoMessages& frame) {
  try {
    const PreparedPair pair =
        processor_->prepare(toStereoInput(frame, topics_, allow_different_frame_ids_));
    const ProcessedFrame processed = processor_->match(pair, offset_, range_);
    diagnostics_->processed(processed, ros::SteadyTime::now());
    warnOf(processed);
    const std_msgs::Header& header = frame.left_image->header;
    outputs_->publish(
        {header, processed, [&] { return colorOf(frame, processed); },
         [&] { return stateAt(header.stamp); },
         [this](const auto& topic, const auto& effect) { warnOfNoSigma(topic, effect); }});
    diagnostics_->published(stateAt(header.stamp).age_ms, ros::SteadyTime::now());
  } catch (const InputError& error) {
    drop(FrameDrop::kBadInput, static_cast<int>(error.fault()), error.what());
  } catch (const std::exception& error) {
    drop(FrameDrop::kFailed, kFailed, error.what());
  }
}

/// Persistent faults of the rig are logged rarely; the diagnostics always show them.
void StereoNodelet::warnOf(const ProcessedFrame& processed) {
  reportRange(processed);
  if (!processed.range_correction.empty()) {
    warn(kRangeClipped, processed.range_correction);
  }
  const std::string offset_warning =
      verticalOffsetWarning(processed, diagnostics_->limits().vertical_offset_px);
  if (!offset_warning.empty() && rig_throttle_.isDue(kVerticalOffset)) {
    NODELET_WARN_STREAM(offset_warning);
  }
  if (!processed.warnings.empty() && rig_throttle_.isDue(kDoubtfulInput)) {
    for (const std::string& warning : processed.warnings) {
      NODELET_WARN_STREAM(warning);
    }
  }
}

void StereoNodelet::reportRange(const ProcessedFrame& processed) {
  const DisparityRange& range = processed.result.range;
  if (processed.range_is_automatic && reported_range_ != range) {
    NODELET_INFO_STREAM("disparity_range is automatic: the disparity range is "
                        << describeRange(range));
  }
  reported_range_ = processed.range_is_automatic ? std::optional(range) : std::nullopt;
}

cv::Mat StereoNodelet::colorOf(const StereoMessages& frame, const ProcessedFrame& processed) {
  const auto image = colors_->find(frame.left_image->header.stamp, colorPatience());
  return toCloudColor(image, color_topic_, processed.left_gray, [this](const std::string& reason) {
    warn(kColorUnusable, "the point cloud is published in gray: " + reason);
  });
}

void StereoNodelet::warnOfNoSigma(const std::string& topic, const std::string& effect) {
  if (without_sigma_.insert(topic).second) {
    NODELET_WARN_STREAM(
        getNodeHandle().resolveName(topic)
        << ": " << effect << ", because the forest file " << forest_name_
        << " has no second forest, which provides the standard deviation. Set the parameter "
        << getPrivateNodeHandle().resolveName("forest")
        << " to a file with both forests, as written by cbmv_train.");
  }
}

std::chrono::milliseconds StereoNodelet::colorPatience() {
  const std::lock_guard<std::mutex> lock(subscriptions_mutex_);
  const bool comes = color_subscriber_ && color_subscriber_.getNumPublishers() > 0;
  return comes ? kColorPatience : std::chrono::milliseconds(0);
}

NodeState StereoNodelet::stateAt(const ros::Time& stamp) const {
  NodeState state;
  state.counts = diagnostics_->counts();
  state.forest = forest_name_;
  state.threads = threads_;
  state.age_ms = secondsBetween(stamp, ros::Time::now()) * 1000;
  return state;
}

void StereoNodelet::drop(FrameDrop drop, int cause, const std::string& message) {
  diagnostics_->dropped(drop, message, ros::SteadyTime::now());
  warn(cause, "frame dropped: " + message);
}

void StereoNodelet::warn(int cause, const std::string& message) {
  if (throttle_.isDue(cause)) {
    NODELET_WARN_STREAM(message);
  }
}

}  // namespace cbmv

PLUGINLIB_EXPORT_CLASS(cbmv::StereoNodelet, nodelet::Nodelet)
