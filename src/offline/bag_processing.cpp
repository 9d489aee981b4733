#include "offline/bag_processing.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <limits>
#include <sstream>
#include <thread>
#include <utility>

#include "io/other_file.h"
#include "offline/double_rectification.h"
#include "offline/frame_files.h"
#include "offline/frame_pipeline.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/parameters.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Describes the image topics and their rectification. Calibration files are described by content,
/// because their paths differ between machines.
std::string describeCamera(const CameraTopics& topics) {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  text << topics.left.name << " " << topics.right.name
       << (topics.left.raw ? " rectified first" : " as they are");
  if (!topics.cameras) {
    return text.str();
  }
  for (const CameraCalibration& camera : {topics.cameras->left, topics.cameras->right}) {
    text << ", " << camera.width << " x " << camera.height << " " << camera.distortion_model;
    const auto append = [&text](const auto& numbers) {
      for (const double number : numbers) {
        text << " " << number;
      }
    };
    append(camera.camera_matrix);
    append(camera.distortion);
    append(camera.rectification);
    append(camera.projection);
  }
  return text.str();
}

/// Everything the frames depend on, independent of folder and machine.
std::string describeOrigin(const BagProcessingOptions& options, const FramePlan& plan,
                           const BagSet& bags, const Forest& forest,
                           const std::vector<std::string>& output_topics) {
  std::ostringstream text;
  text << "{\n\"inputs\": \"";
  for (const auto& bag : bags.bags()) {
    text << fs::path(bag->path()).filename().string() << " (" << bag->fileSize() << " bytes";
    if (!bag->entries().empty()) {
      text << " from " << bag->entries().front().time;
    }
    text << ") ";
  }
  text << "\",\n\"topics\": \"" << describeCamera(plan.topics);
  for (const std::string& topic : output_topics) {
    text << " " << topic;
  }
  if (options.files) {
    text << (*options.files == DisparityFormat::kKitti ? " as files for KITTI" : " as files");
  }
  const PlanOptions& part = options.plan;
  text << "\",\n\"part\": \"start " << part.start_s << " s, duration " << part.duration_s
       << " s, every " << part.every << ", stamps within " << part.max_stamp_difference_s << " s, "
       << plan.frames.size() << " frames\",\n\"forest\": \"" << forest.name
       << "\",\n\"minimal confidence\": " << options.matching.min_confidence
       << ",\n\"different frame_ids\": " << options.matching.allow_different_frame_ids
       << ",\n\"version\": \"" << CBMV_VERSION << "\",\n\"parameters\": \"";
  std::string parameters = describeOptions(options.matching.stereo);
  std::replace(parameters.begin(), parameters.end(), '\n', ';');
  text << parameters << "\"\n}\n";
  return text.str();
}

/// The messages of other topics in the processed part of the bag.
std::vector<BagMessage> otherMessages(const BagSet& bags, const FramePlan& plan,
                                      const std::vector<std::string>& output_topics) {
  std::vector<BagMessage> others;
  for (const BagMessage& message : bags.messages()) {
    const std::string& topic = message.connection().topic;
    if (plan.isInPart(message) &&
        std::find(output_topics.begin(), output_topics.end(), topic) == output_topics.end()) {
      others.push_back(message);
    }
  }
  return others;
}

int threadsOf(const StereoOptions& options) {
  return options.threads > 0 ? options.threads
                             : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Number of frames in the parts without messages.
std::size_t countFailed(const Segments& segments, const std::string& any_topic) {
  std::size_t written = 0;
  for (const std::string& path : segments.paths()) {
    const BagReader reader(path);
    for (const BagEntry& entry : reader.entries()) {
      written += reader.connections()[entry.connection]->topic == any_topic;
    }
  }
  return segments.framesDone() - written;
}

/// Writes the output from its parts.
void mergeParts(const BagProcessingOptions& options, const BagSet& bags,
                const BagProcessingSummary& summary, const FrameOutputs& outputs,
                std::optional<ShardLabel> label, Segments& segments) {
  const std::vector<BagMessage> others = options.copy
                                             ? otherMessages(bags, summary.plan, outputs.topics())
                                             : std::vector<BagMessage>();
  BagWriter writer(options.output + ".part", compressionOf(options.compression));
  if (label) {
    label->failed = summary.failed;
    writer.write(toMessage(*label), summary.plan.begin);
  }
  mergeBags(segments.paths(), others, writer);
  writer.finish(options.output);
  segments.remove();
}

/// Limits the plan to the requested shard.
std::optional<ShardLabel> chooseShard(const BagProcessingOptions& options,
                                      const std::string& origin, bool damaged, FramePlan& plan) {
  if (!options.shard) {
    return std::nullopt;
  }
  cutToShard(*options.shard, plan);
  const std::string copies = options.copy ? "with the other topics" : "";
  return ShardLabel{*options.shard, plan.first, plan.frames.size(), 0, damaged, origin + copies};
}

/// Runs the pipeline. If writing fails, the frames written until then are kept.
PipelineReport runAndKeep(const PipelineParts& parts, Segments& segments,
                          const BagProcessingSummary& summary) {
  try {
    PipelineReport report =
        runPipeline(parts, summary.plan.first + summary.resumed, summary.threads);
    segments.closePart();
    return report;
  } catch (const Error&) {
    segments.closePart();
    throw;
  }
}

/// Processes the frames that are not in the parts yet.
void processFrames(const PipelineParts& parts, Segments& segments, BagProcessingSummary& summary) {
  const double begin_s = steadySeconds();
  const std::clock_t begin_clock = std::clock();
  const PipelineReport report = runAndKeep(parts, segments, summary);
  summary.seconds = steadySeconds() - begin_s;
  summary.cpu_seconds = static_cast<double>(std::clock() - begin_clock) / CLOCKS_PER_SEC;
  summary.processed = report.frames;
  summary.failures = report.failures;
  for (const auto& [warning, frames] : report.warnings) {
    summary.warnings.push_back(warning);
  }
  summary.matching_seconds = report.matching_seconds;
  summary.interrupted = segments.framesDone() < summary.plan.framesToProcess();
}

void requireFitting(const BagProcessingOptions& options) {
  for (const std::string& input : options.inputs) {
    requireOtherFile(input, options.output);
  }
  const auto compression = compressionOf(options.compression);
  const bool compressed = compression != rosbag::compression::Uncompressed;
  if (options.files && (options.copy || compressed || options.shard)) {
    const std::string option = options.copy ? "--copy" : compressed ? "--compression" : "--shard";
    throw Error(option + " works only with bag output. Leave it out, or use --format bag");
  }
}

void makeMessages(const FrameOutputs& outputs, PipelineParts& parts) {
  parts.make = [&outputs](const PlannedFrame& /*planned*/, const PreparedFrame& prepared,
                          const ProcessedFrame& processed) {
    return outputs.make(prepared, processed);
  };
  parts.make_failed = [](const PlannedFrame& /*planned*/, const std::string& /*reason*/) {
    return std::vector<RawMessage>();
  };
}

void makeFiles(const FramePlan& plan, FrameFiles& files, PipelineParts& parts) {
  const auto number = [&plan](const PlannedFrame& planned) {
    return static_cast<std::size_t>(&planned - plan.frames.data());
  };
  parts.make = [=, &files](const PlannedFrame& planned, const PreparedFrame& prepared,
                           const ProcessedFrame& processed) {
    return std::vector<RawMessage>{files.write(number(planned), prepared, processed)};
  };
  parts.make_failed = [=, &files](const PlannedFrame& planned, const std::string& reason) {
    const ros::Time& stamp = planned.left.entry->stamp;
    return std::vector<RawMessage>{files.failed(number(planned), stamp, reason)};
  };
}

std::string rowsWarning(const CameraTopics& topics, const PlannedFrame& first,
                        const StereoOptions& options) {
  const std::string rectified_twice =
      topics.left.raw ? doubleRectificationWarning(topics, first, options) : std::string();
  return rectified_twice.empty() ? verticalOffsetWarning(topics, first, options) : rectified_twice;
}

/// Plans the work without doing any of it.
BagProcessingSummary planProcessing(const BagProcessingOptions& options, const BagSet& bags) {
  BagProcessingSummary summary;
  summary.damages = bags.damages();
  PlanOptions plan = options.plan;
  plan.offset_interval_s = options.matching.stereo.rectification.interval_s;
  summary.plan = planFrames(bags, findCameraTopics(bags, options.topics), plan);
  summary.threads = threadsOf(options.matching.stereo);
  const PlanProblems problems = findProblems(summary.plan);
  if (!problems.nothing_to_process.empty()) {
    summary.problems.push_back(problems.nothing_to_process);
  }
  summary.warnings = problems.others;
  if (!summary.plan.frames.empty()) {
    const std::string warning =
        rowsWarning(summary.plan.topics, summary.plan.frames.front(), options.matching.stereo);
    if (!warning.empty()) {
      summary.warnings.push_back(warning);
    }
  }
  return summary;
}

/// Creates the output from the parts. If all frames failed, no bag is written, because it would
/// look like a result.
void finishOutput(const BagProcessingOptions& options, const BagSet& bags,
                  const FrameOutputs& outputs, const std::optional<ShardLabel>& label,
                  const FrameFiles* files, Segments& segments, BagProcessingSummary& summary) {
  if (summary.interrupted) {
    return;
  }
  const bool all_failed = summary.failed == summary.plan.framesToProcess();
  if (files != nullptr) {
    files->writeIndex(segments.paths());
    segments.remove();
  } else if (all_failed && !label) {
    // After resuming, the reasons for earlier failures are unknown.
    const auto& failures = summary.failures;
    summary.problems.push_back("all frames failed" +
                               (failures.empty() ? "" : ": " + failures.begin()->first) +
                               ". Check the input with cbmv_bag check");
    segments.remove();
    return;
  } else {
    mergeParts(options, bags, summary, outputs, label, segments);
  }
  summary.was_written = true;
}

/// Writes a frame and reports the progress.
decltype(PipelineParts::write) writerOf(Segments& segments, const BagProcessingEvents& events,
                                        const BagProcessingSummary& summary) {
  return [&segments, &events, done = summary.resumed, total = summary.plan.framesToProcess()](
             const std::vector<RawMessage>& messages, const ros::Time& time) mutable {
    segments.write(messages, time);
    if (events.progress) {
      events.progress(++done, total);
    }
  };
}

}  // namespace

BagProcessingSummary processBags(const BagProcessingOptions& options,
                                 const std::shared_ptr<const Forest>& forest,
                                 const BagProcessingEvents& events) {
  requireFitting(options);  // before any other work
  const BagSet bags(options.inputs);
  BagProcessingSummary summary = planProcessing(options, bags);
  if (summary.plan.frames.empty() && !options.shard) {
    return summary;
  }
  const FrameOutputs outputs(options.outputs, summary.plan.topics);
  const std::string origin = describeOrigin(options, summary.plan, bags, *forest, outputs.topics());
  const std::optional<ShardLabel> label =
      chooseShard(options, origin, !summary.damages.empty(), summary.plan);
  const auto files = options.files
                         ? std::make_unique<FrameFiles>(options.output, outputs, *options.files)
                         : nullptr;
  Segments segments(files ? files->indexPath() : options.output,
                    label ? origin + describeShard(label->shard) + "\n" : origin, options.earlier);
  segments.setFramesPerPart(options.frames_per_part);
  summary.was_complete = segments.isComplete();
  if (summary.was_complete) {
    summary.was_written = true;
    return summary;
  }
  summary.resumed = segments.framesDone();
  if (events.begin) {
    events.begin(summary);
  }
  FrameLoader loader(summary.plan.topics, outputs.needsColor());
  FrameProcessor processor(forest, options.matching.stereo);
  processor.setMinConfidence(options.matching.min_confidence);
  PipelineParts parts{summary.plan, loader, processor, options.matching.allow_different_frame_ids,
                      {},           {},     {},        events.should_stop};
  if (files) {
    files->begin(options.earlier == EarlierParts::kOverwrite);
    segments.setBeforePart([&] { files->sync(); });
    makeFiles(summary.plan, *files, parts);
  } else {
    makeMessages(outputs, parts);
  }
  parts.write = writerOf(segments, events, summary);
  processFrames(parts, segments, summary);
  summary.failed =
      countFailed(segments, files ? FrameFiles::doneTopic() : outputs.topics().front());
  finishOutput(options, bags, outputs, label, files.get(), segments, summary);
  return summary;
}

}  // namespace cbmv
