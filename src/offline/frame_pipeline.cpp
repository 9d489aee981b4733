#include "offline/frame_pipeline.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#if __has_include(<tbb/parallel_pipeline.h>)
#include <tbb/parallel_pipeline.h>
#else
#include <tbb/pipeline.h>  // TBB 2020
#endif

namespace cbmv {
namespace {

#if __has_include(<tbb/parallel_pipeline.h>)
using Mode = tbb::filter_mode;
#else
using Mode = tbb::filter;
#endif

double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A frame in the pipeline.
struct Job {
  const PlannedFrame* planned = nullptr;
  const PlannedFrame* offset_source = nullptr;  ///< null: keep the previous offset
  VerticalOffset offset;                        ///< set if there is a source
  std::optional<PreparedFrame> prepared;
  std::optional<ProcessedFrame> processed;
  std::vector<RawMessage> messages;
  std::string failure;
};

/// Runs a step of a job unless an earlier step failed.
template <typename Step>
void attempt(Job& job, const Step& step) {
  if (job.failure.empty()) {
    try {
      step(job);
    } catch (const InputError& error) {
      job.failure = error.what();
    }
  }
}

/// The stages of the pipeline and their counters.
class Steps {
 public:
  Steps(const PipelineParts& parts, std::size_t first, std::size_t frames_in_flight)
      : parts_(parts), first_(first), next_(first), jobs_(frames_in_flight) {}

  Job* begin(tbb::flow_control& control) {
    const std::vector<PlannedFrame>& frames = parts_.plan.frames;
    if (next_ >= frames.size() || (parts_.should_stop && parts_.should_stop())) {
      control.stop();
      return nullptr;
    }
    Job& job = jobs_[next_ % jobs_.size()];
    job.planned = &frames[next_];
    const std::size_t offset_frame = job.planned->offset_frame;
    if (next_ == first_ || offset_frame != frames[next_ - 1].offset_frame) {
      job.offset_source = &parts_.plan.offset_frames[offset_frame];
    }
    ++next_;
    return &job;
  }

  Job* prepare(Job* job) const {
    attempt(*job, [this](Job& j) { prepareJob(j); });
    if (job->offset_source != nullptr) {
      job->offset = estimateOffset(*job);
    }
    return job;
  }

  Job* match(Job* job) {
    if (job->offset_source != nullptr) {
      offset_ = job->offset;
    }
    attempt(*job, [this](Job& j) {
      const double begin_s = steadySeconds();
      GivenOffset offset(offset_);
      j.processed = parts_.processor.match(j.prepared->pair, offset);
      report_.matching_seconds += steadySeconds() - begin_s;
      for (const std::string& warning : j.processed->warnings) {
        ++report_.warnings[warning];
      }
    });
    return job;
  }

  Job* makeMessages(Job* job) const {
    attempt(*job,
            [this](Job& j) { j.messages = parts_.make(*j.planned, *j.prepared, *j.processed); });
    if (!job->failure.empty()) {
      job->messages = parts_.make_failed(*job->planned, job->failure);
    }
    job->prepared.reset();
    job->processed.reset();
    return job;
  }

  void write(Job* job) {
    if (!job->failure.empty()) {
      ++report_.failures[job->failure];
    }
    parts_.write(job->messages, job->planned->left.entry->time);
    ++report_.frames;
    *job = {};
  }

  const PipelineReport& report() const { return report_; }

 private:
  void prepareJob(Job& job) const {
    job.prepared = prepareFrame(parts_.loader.load(*job.planned), parts_.loader.topicNames(),
                                parts_.loader.rectifiedBy(), parts_.allow_different_frame_ids,
                                parts_.processor);
  }

  /// Zero if its source frame cannot be used.
  VerticalOffset estimateOffset(Job& job) const {
    Job other;
    other.planned = job.offset_source;
    const bool is_own = job.offset_source->left.entry == job.planned->left.entry;
    if (!is_own) {
      attempt(other, [this](Job& j) { prepareJob(j); });
    }
    Job& source = is_own ? job : other;
    attempt(source,
            [this](Job& j) { j.offset = parts_.processor.estimateOffset(j.prepared->pair); });
    return source.offset;
  }

  const PipelineParts& parts_;
  const std::size_t first_;
  std::size_t next_;
  /// Frames finish in order, so a slot is free when its turn comes again. Not created by the
  /// pipeline, which leaks frames in progress if a step throws.
  std::vector<Job> jobs_;
  VerticalOffset offset_;  ///< current offset at the matcher
  PipelineReport report_;
};

}  // namespace

PipelineReport runPipeline(const PipelineParts& parts, std::size_t first, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  const std::size_t frames_in_flight = static_cast<std::size_t>(std::min(threads, 8)) + 2;
  Steps steps(parts, first, frames_in_flight);
  // The matcher uses the same arena; with two arenas, threads would migrate between them.
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_pipeline(
        frames_in_flight,
        tbb::make_filter<void, Job*>(Mode::serial_in_order, [&](tbb::flow_control& c) {
          return steps.begin(c);
        }) & tbb::make_filter<Job*, Job*>(Mode::parallel, [&](Job* j) {
          return steps.prepare(j);
        }) & tbb::make_filter<Job*, Job*>(Mode::serial_in_order, [&](Job* j) {
          return steps.match(j);
        }) & tbb::make_filter<Job*, Job*>(Mode::parallel, [&](Job* j) {
          return steps.makeMessages(j);
        }) & tbb::make_filter<Job*, void>(Mode::serial_in_order, [&](Job* j) { steps.write(j); }));
  });
  return steps.report();
}

}  // namespace cbmv
