#pragma once
#include <chrono>
#include <memory>
#include <tuple>

#include "pbrt/build/built_scene.h"
#include "pbrt/cmd/pbrt/command_line.h"
#include "pbrt/core/files.h"
#include "pbrt/core/log.h"
#include "pbrt/core/online_model.h"
#include "pbrt/core/progress.h"
#include "pbrt/films/render_file.h"

namespace pbrt {

/// Checkpoint of one render: read with --resume before the scene is built, written during rendering.
class Checkpoint {
  public:
    /// Reads the file if the render is resumed and the file exists. Changes `build` so that the samples match the first
    /// run. `lightsHash`: of the --load-lights file, or empty. Throws UserError if the file is damaged, belongs to
    /// another render, or exists without --resume.
    static Checkpoint Open(const CommandLine &options, const SceneDescription &d, const std::string &lightsHash,
                           BuildOptions *build) {
        Checkpoint c;
        c.path_ = options.checkpoint;
        c.isTimed_ = options.timeBudget > 0;
        c.isEndOpen_ = c.isTimed_ || options.noise > 0;
        const bool exists = FileExists(c.path_);
        if (exists && !options.resume)
            throw UserError("{}: exists already; use --resume, or delete it to start again.", c.path_);
        CheckWritable(c.path_);
        c.head_.identity = IdentityOf(*build, options.sceneFiles, d);
        if (!lightsHash.empty()) c.head_.identity["--load-lights"] = fmt::format("a file with the hash {}", lightsHash);
        if (options.noise > 0) c.head_.identity["--noise"] = "";  // its level may change
        if (exists) {
            c.Resume(options, build);
            return c;
        }
        if (options.resume) LogInfo("{} does not exist: starting a new render.", c.path_);
        c.head_.samplesFlag = build->samplesPerPixel;
        c.head_.isPart = options.samples.has_value();
        if (options.samples) std::tie(c.head_.first, c.head_.end) = *options.samples;
        c.head_.film = {d.film.type, d.film.params, d.film.colorSpace, ExposureTime(d.camera.params),
                        FilmOverridesOf(*build)};
        return c;
    }

    bool IsResumed() const { return file_ != nullptr; }
    const std::string &Path() const { return path_; }
    const RenderFileHead &Head() const { return head_; }
    /// Requires IsResumed(); call before Begin.
    StateReader Learned() const { return file_->Learned(); }
    /// Loads the film and sets the resume position in `settings`; the integrator must be prepared. Throws UserError.
    void Begin(const BuiltScene &built, RenderSettings *settings) {
        if (!file_) {
            head_.samplesPerBatch = built.samplesPerPixel;
            if (isTimed_) head_.samplesFlag = built.integratorRequest.options.samplesPerPixel;  // as --time planned
            if (!head_.isPart) head_.end = built.samplesPerPixel;
            if (head_.end > built.samplesPerPixel)
                throw UserError("--samples {}: the render has only {} per pixel; see --spp.",
                                RangeText(head_.first, head_.end), CountText(built.samplesPerPixel, "sample"));
            settings->firstSample = head_.done = head_.first;
            settings->endSample = head_.end;
            return;
        }
        file_->LoadFilm(*built.film);
        settings->from = RenderPosition{head_.done, head_.passCount, file_->PassDone(), path_, {}};
        int batchLeft = head_.samplesPerBatch - head_.done % head_.samplesPerBatch;
        if (built.half) {
            settings->from->plan = file_->Plan(PixelCells(built.film->PixelBounds()));
            file_->LoadHalf(*built.half);
            batchLeft = settings->from->plan.end - head_.done;
        }
        const OnlineModel *model = built.integrator->Model();
        const int next = model ? model->NextUpdate() : 0, ahead = head_.done + head_.passCount;
        StateReader({}, path_).Require(head_.samplesPerBatch == built.samplesPerPixel && head_.passCount <= batchLeft &&
                                           head_.passCount <= built.integrator->MaxPassSamples() &&
                                           (head_.passCount > 0) == !settings->from->passDone.empty() &&
                                           (next == 0 || next >= ahead),
                                       "its sample counts do not match the scene");
        if (head_.done > head_.first) settings->secondsPerSample = head_.renderSeconds / (head_.done - head_.first);
        // Earlier runs count towards the budget.
        settings->start -= std::chrono::duration_cast<std::chrono::steady_clock::duration>(
            std::chrono::duration<double>(secondsBefore_));
        settings->secondsBefore = head_.renderSeconds;
        settings->firstSample = head_.first;
        settings->endSample = head_.end;
        LogInfo("Resuming from {}, after {} per pixel.", path_, CountText(head_.done - head_.first, "sample"));
        file_.reset();  // frees its memory
    }
    /// Writes the file; `seconds` of rendering. Failures are logged as warnings; Failure() is the message of the last
    /// call.
    void Write(const BuiltScene &built, const RenderPosition &position, double seconds, const ImageMetadata &metadata) {
        head_.done = position.done;
        head_.passCount = position.passCount;
        head_.seconds = secondsBefore_ + SecondsSince(start_);
        head_.renderSeconds = seconds;
        head_.metadata = metadata;
        RenderFileHead written = head_;
        if (isEndOpen_) written.end = 0;
        StateWriter learned;
        built.integrator->SaveLearned(learned, true);
        failure_.clear();
        try {
            std::optional<AdaptiveState> adaptive;
            if (built.half) adaptive.emplace(AdaptiveState{position.plan, *built.half});
            WriteRenderFile(path_, written, position.passDone, *built.film, learned, adaptive ? &*adaptive : nullptr);
        } catch (const UserError &e) {
            failure_ = e.Diagnostics()[0].message;
            LogWarning("the checkpoint after {} per pixel was not written. {}", CountText(position.done, "sample"),
                       failure_);
        }
    }
    const std::string &Failure() const { return failure_; }

  private:
    Checkpoint() = default;
    static std::string RangeText(int first, int end) { return fmt::format("{}:{}", first, end); }
    void Resume(const CommandLine &options, BuildOptions *build) {
        file_ = std::make_unique<RenderFile>(path_);
        const RenderFileHead &old = file_->Head();
        auto fail = [&](const std::string &why) { throw UserError("{}: {}.", path_, why); };
        if (const std::string differences = DifferencesOf(head_.identity, old.identity, path_); !differences.empty())
            fail("belongs to another render: " + differences);
        if (old.isPart != options.samples.has_value())
            fail(old.isPart ? fmt::format("is a part of a render; use --samples {}", RangeText(old.first, old.end))
                            : "is the checkpoint of a whole render, without --samples");
        if (options.samples && *options.samples != std::pair(old.first, old.end))
            fail(fmt::format("has the samples {}, not {}", RangeText(old.first, old.end),
                             RangeText(options.samples->first, options.samples->second)));
        const int spp = build->samplesPerPixel;
        if (old.isPart && spp > 0 && spp != old.samplesFlag)
            fail(fmt::format(
                "is a part of a render with {}, not --spp {}",
                old.samplesFlag > 0 ? fmt::format("--spp {}", old.samplesFlag) : "the scene's number of samples", spp));
        head_ = old;
        if (!old.isPart && spp > 0) head_.end = spp;
        if (head_.end == 0) head_.end = old.samplesPerBatch;
        if (!isTimed_ && head_.end < old.done + old.passCount)
            fail(fmt::format("has {} per pixel already{}; --spp can only be larger", CountText(old.done, "sample"),
                             old.passCount > 0 ? fmt::format(", and some up to {}", old.done + old.passCount) : ""));
        secondsBefore_ = old.seconds;
        build->samplesPerPixel = old.samplesFlag;
    }

    std::string path_, failure_;
    RenderFileHead head_;
    std::unique_ptr<RenderFile> file_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    double secondsBefore_ = 0;
    bool isTimed_ = false, isEndOpen_ = false;
};

}  // namespace pbrt
