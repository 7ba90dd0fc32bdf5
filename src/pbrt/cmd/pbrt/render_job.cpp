#include "pbrt/cmd/pbrt/render_job.h"

#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "pbrt/cmd/pbrt/checkpoint.h"
#include "pbrt/cmd/pbrt/image_output.h"
#include "pbrt/cmd/pbrt/learned_lights.h"
#include "pbrt/cmd/pbrt/run_report.h"
#include "pbrt/scenefile/parser.h"

namespace pbrt {
namespace {

/// Maximum seconds for writing an image after a signal: more than disks need, less than schedulers wait.
constexpr double kWritingSeconds = 10;

/// Maximum wave length in seconds while a viewer is connected. Shorter waves cost more.
constexpr double kLiveWaveSeconds = 3;

void PrintWarnings(const DiagnosticSink &sink, size_t *printed) {
    bool color = isatty(STDERR_FILENO) != 0;
    const std::vector<Diagnostic> &all = sink.All();
    for (; *printed < all.size(); ++*printed)
        if (all[*printed].severity == Severity::Warning) LogInfo(Format(all[*printed], color));
}

/// Throws UserError if parts are to be rendered adaptively, if noise cannot be estimated, or if side images, which stay
/// in one process's memory, are combined with checkpoints or several ranks.
void CheckCombination(const CommandLine &options, const BuiltScene &built, const Team &team) {
    if (options.samples && !options.build.film.filename.empty())
        LogWarning("--outfile has no effect with --samples: a part makes no image; imgtool merge names it.");
    if (options.samples && built.half)
        throw UserError(
            "--samples: the scene's \"bool adaptive\" gives pixels different numbers of samples; parts need "
            "\"false\".");
    const Param *how = built.integratorRequest.sampler.params.Find("randomization", ParamType::String);
    if (options.noise > 0 && how && how->strings[0] == "none")
        throw UserError(how->loc,
                        "--noise compares two independent halves of the samples; \"none\" makes them depend on each "
                        "other. Valid here: the other values of \"randomization\".");
    if (!built.integrator->MakesSideImages()) return;
    if (!options.checkpoint.empty() || team.Size() > 1)
        throw UserError(
            "\"visualizestrategies\" and \"visualizeweights\" exclude --checkpoint, --samples and mpirun: images "
            "of single strategies are neither stored in checkpoints nor sent to other processes.");
}

std::string NothingWritten(const char *phase) {
    return fmt::format("Interrupted while {}: no image was written.", phase);
}

class ImageWriter {
  public:
    ImageWriter(const CommandLine &options, const BuiltScene &built, const Timings &timings, SignalWatch &signals)
        : options_(options), built_(built), timings_(timings), signals_(signals), output_(built.filename) {}

    /// Writes an unfinished image after a wave. Failures are warnings only, because the final image may succeed.
    void WritePartial(const RenderResult &result) {
        try {
            SetWriting(output_.Filename());
            output_.WriteUnfinished(built_.film->ToImage(), Describe(result));
        } catch (const UserError &e) {
            LogWarning("the image after {} per pixel was not written; rendering continues. {}",
                       CountText(result.samplesTaken, "sample"), e.Diagnostics()[0].message);
        }
        SetRendering();
    }

    /// Writes the final image and side images. Returns the image's file name; empty if nothing is written.
    std::string Write(const RenderResult &result, DiagnosticSink &failures) {
        if (result.cancelled && result.samplesTaken == 0) {
            LogInfo("Interrupted before every pixel had a sample: no image was written.");
            return {};
        }
        const std::string written = Save(output_.Filename(), *built_.film, result, failures, [&](const auto &...image) {
            if (result.cancelled) return output_.WriteUnfinished(image...);
            output_.WriteFinished(image...);
            return output_.Filename();
        });
        const bool isKept = result.cancelled && !failures.HasErrors() && written != output_.Filename();
        for (const SideImage &side : built_.integrator->SideImages()) {
            const std::string beside = WithSuffix(isKept ? written : output_.Filename(), "-" + side.name);
            Save(beside, *side.film, result, failures, [&](const auto &...image) {
                WriteImage(beside, image...);
                return beside;
            });
        }
        if (result.cancelled && !written.empty()) LogInfo("Interrupted: the image holds what was rendered.");
        if (isKept) LogInfo("{} is kept: it has more samples of this scene, or an unknown number.", output_.Filename());
        return written;
    }

    void SetRendering() const {
        signals_.Cancel("Interrupted; saving what was rendered. A second signal ends at once.",
                        "Interrupted again: the last samples were not saved.", SignalWatch::kForever);
    }

  private:
    /// Writes an image by write(image, metadata), which returns its name. If that fails, with an error in `failures`,
    /// writes a new file beside the scene, in the working directory or in that of temporary files. Returns the name of
    /// the written file; empty if there is none.
    std::string Save(const std::string &name, const Film &film, const RenderResult &result, DiagnosticSink &failures,
                     auto &&write) const {
        SetWriting(name);
        const Image image = film.ToImage();
        const ImageMetadata metadata = Describe(result);
        std::string written;
        if (Collect(failures, [&] { written = write(image, metadata); })) return written;
        namespace fs = std::filesystem;
        std::error_code none;
        const fs::path old(name), beside = fs::path(options_.sceneFiles[0]).parent_path();
        const std::string stem = old.stem().string().substr(0, 200);  // file names have at most 255 bytes
        for (const fs::path &folder : {beside, fs::path(), fs::temp_directory_path(none)}) {
            const fs::path path = folder / fmt::format("{}-rescued-{}{}", stem, getpid(), old.extension().string());
            DiagnosticSink ignored;
            if (FileExists(path) || !Collect(ignored, [&] { WriteImage(path, image, metadata); })) continue;
            failures.Error({}, "{}: this image is in {} instead.", name, path.string());
            return path;
        }
        return {};
    }
    void SetWriting(const std::string &name) const {
        signals_.Cancel(fmt::format("Interrupted; writing {} is finished first. A second signal ends at once.", name),
                        fmt::format("Interrupted while writing: {} was not written.", name), kWritingSeconds);
    }
    ImageMetadata Describe(const RenderResult &result) const {
        return DescribeImage(options_, built_, result, timings_);
    }

    const CommandLine &options_;
    const BuiltScene &built_;
    const Timings &timings_;
    SignalWatch &signals_;
    ImageOutput output_;
};

/// Distributes rank 0's checkpoint to all ranks. In other ranks `learned` then refers to `memory`.
void ShareCheckpoint(Team &team, BuildOptions *build, std::optional<StateReader> *learned, std::string *memory) {
    if (team.Size() == 1) return;
    team.Meet();
    StateWriter out;
    if (team.IsRank0()) {
        out(build->samplesPerPixel, learned->has_value());
        if (*learned) {
            StateReader all = **learned;
            const std::string_view bytes = all.Take(all.BytesLeft());
            out.Refer(bytes.data(), bytes.size());
        }
    }
    *memory = team.Broadcast(out);
    if (team.IsRank0()) return;
    StateReader in(*memory, "the checkpoint");
    in(build->samplesPerPixel);
    if (in.Value<bool>()) *learned = StateReader(in.Take(in.BytesLeft()), "the checkpoint");
}

/// Sets samples per pixel to what --time allows, measured on rank 0. So everything that depends on it (prepass, guide,
/// pixel sampler) matches the equivalent --spp. `start`: of the budget.
void PlanSamples(double budget, std::chrono::steady_clock::time_point start, Team &team, BuiltScene &built) {
    int samples = 0;
    if (team.IsRank0()) {
        const auto left = [&] { return budget - SecondsSince(start); };
        const std::unique_ptr<Integrator> plain = MakePlainIntegrator(built);
        Progress silent;
        PrepareContext context = built.Preparation(silent);
        plain->Prepare(context);
        const std::unique_ptr<Film> scratch = built.film->MakeRgbFilm();
        double perSample = MeasureSecondsPerSample(
            {*plain, *built.camera, *built.filter, *scratch, *built.sampler, silent}, built.Settings(), left());
        perSample *= double(ThreadCount()) / team.TotalThreads();
        samples = FittingSamples(left(), perSample);
    }
    team.Meet();
    samples = team.BroadcastValue(samples);
    built.SetSamples(samples);
    LogInfo("--time {}: prepared for {} per pixel, as by --spp {}.", budget, CountText(samples, "sample"), samples);
}

/// Sums the counters of all ranks on rank 0; returns the sum of sent bytes there.
uint64_t ReduceCounters(Team &team) {
    uint64_t sent = team.BytesSent();
    team.Reduce([&](StateWriter &out) { out(SumCounters(), sent); },
                [&](StateReader &in) {
                    ThreadCounters() += in.Value<RenderCounters>();
                    sent += in.Value<uint64_t>();
                });
    return sent;
}

class RenderJob {
  public:
    RenderJob(const CommandLine &options, const PluginRegistry &registry, Team &team, Progress &progress,
              SignalWatch &signals, LiveView &live)
        : options_(options), registry_(registry), team_(team), progress_(progress), signals_(signals), live_(live),
          build_(options.build) {}

    int Run() {
        signals_.EndAtOnce(NothingWritten("reading"));
        SceneDescription description = Read();
        // Here and below, a signal after the line "done" belongs to the following phase.
        signals_.EndAtOnce(NothingWritten("building"));
        timings_.read = progress_.EndPhase();
        built_.emplace(Build(description));
        signals_.EndAtOnce(NothingWritten("preparing lights"));
        timings_.build = progress_.EndPhase();
        PrepareLights();
        return team_.IsRank0() ? Render() : FollowRender();
    }

  private:
    SceneDescription Read() {
        if (team_.Size() > 1 && std::ranges::count(options_.sceneFiles, "-") > 0)
            throw UserError("under mpirun the scene must be in files: only one process gets the standard input.");
        progress_.BeginPhase("reading", 0);
        SceneDescription description = ParseSceneFiles(options_.sceneFiles, sink_);
        PrintWarnings(sink_, &printed_);
        sink_.ThrowIfErrors();
        build_.checksOutput = build_.checksOutput && team_.IsRank0();
        learnedLights_ = LearnedLights::Open(options_);
        // In world coordinates the lights of all frames of an animation are identical, independent of the camera.
        if (learnedLights_->AreUsed() && build_.renderCoordSys.empty() && !description.options.renderCoordSys)
            build_.renderCoordSys = "world";
        if (!options_.checkpoint.empty() && team_.IsRank0())
            checkpoint_ = Checkpoint::Open(options_, description, learnedLights_->Hash(), &build_);
        if (checkpoint_ && checkpoint_->IsResumed()) learned_.emplace(checkpoint_->Learned());
        ShareCheckpoint(team_, &build_, &learned_, &shared_);
        return description;
    }

    BuiltScene Build(SceneDescription &description) {
        progress_.BeginPhase("building", 0);
        BuiltScene built = [&] {
            try {
                return BuildScene(description, build_, registry_, sink_, progress_);
            } catch (...) {
                PrintWarnings(sink_, &printed_);
                throw;
            }
        }();
        description.shapes.clear();
        PrintWarnings(sink_, &printed_);
        learnedLights_->Check(built);
        CheckCombination(options_, built, team_);
        team_.Meet();
        return built;
    }

    /// Prepares the integrator from the checkpoint, from learned lights, or anew.
    void PrepareLights() {
        BuiltScene &built = *built_;
        if (options_.build.quick)
            LogInfo("--quick: {} x {} pixels{}.", built.film->FullResolution().x, built.film->FullResolution().y,
                    options_.timeBudget > 0
                        ? ""
                        : fmt::format(", {} per pixel", CountText(built.samplesPerPixel, "sample")));
        progress_.BeginPhase("preparing lights", 0);
        // A resumed render has its number of samples from the checkpoint. Only light samplers and guides learn.
        if (options_.timeBudget > 0 && !learned_ && built.integrator->Lights())
            PlanSamples(options_.timeBudget, start_, team_, built);
        settings_.emplace(built.Settings());
        settings_->timeBudget = options_.timeBudget;
        settings_->noise = options_.noise;
        settings_->start = start_;
        PrepareContext context = built.Preparation(progress_, team_);
        if (!learned_ && learnedLights_->AreLoaded()) {
            learned_.emplace(learnedLights_->Learned());
            context.learnsOn = false;
        }
        if (learned_) context.learned = &*learned_;
        built.integrator->Prepare(context);
        // Learned lights may contain more than this integrator uses.
        if (learned_ && context.learnsOn) learned_->RequireEnd();
        timings_.prepare = progress_.EndPhase();
        if (checkpoint_) checkpoint_->Begin(built, &*settings_);
        ResetCounters();
        team_.Meet();
        team_.EndMeetings();
    }

    int FollowRender() {
        signals_.Cancel("", "", SignalWatch::kForever);
        FollowWaves(built_->Rendering(progress_, team_), *settings_);
        ReduceCounters(team_);
        signals_.EndAtOnce("");
        return signals_.Status();
    }

    /// Sets the callbacks between waves: partial images, live images, checkpoints.
    void SetCallbacks(ImageWriter &writer) {
        RenderSettings &settings = *settings_;
        if (options_.writePartialImages || live_.HasViewers())
            settings.afterWave = [this, &settings, &writer](const RenderResult &until) {
                // The last image follows at the end of the render.
                if (options_.timeBudget <= 0 && until.samplesTaken == settings.SampleCount()) return;
                if (live_.HasViewers())
                    settings.maxWaveSeconds = std::max(kLiveWaveSeconds, live_.AfterWave(*built_->film, until));
                if (options_.writePartialImages) writer.WritePartial(until);
            };
        if (live_.HasViewers()) {
            settings.maxWaveSeconds = kLiveWaveSeconds;
            live_.Begin({.scene = fmt::format("{}", fmt::join(options_.sceneFiles, " ")),
                         .filename = built_->filename,
                         .fullResolution = built_->film->FullResolution(),
                         .pixelBounds = built_->film->PixelBounds(),
                         .samples = settings.HasKnownEnd() ? settings.SampleCount() : 0,
                         .timeBudget = options_.timeBudget});
        }
        // Checkpoints require a completed preparation.
        if (checkpoint_ && !progress_.Cancelled()) {
            settings.checkpointInterval = options_.checkpointInterval;
            settings.checkpoint = [this](const RenderPosition &position, const RenderResult &until) {
                checkpoint_->Write(*built_, position, until.seconds, DescribeImage(options_, *built_, until, timings_));
            };
        }
    }

    int Render() {
        BuiltScene &built = *built_;
        ImageWriter writer(options_, built, timings_, signals_);
        SetCallbacks(writer);
        writer.SetRendering();
        const RenderResult result = RenderWaves(built.Rendering(progress_, team_), *settings_);
        const uint64_t sent = ReduceCounters(team_);
        timings_.render = result.seconds - settings_->secondsBefore;
        live_.Finish(*built.film, result);
        progress_.BeginPhase("writing", 0);
        DiagnosticSink failures;  // after each of them, everything else is still written
        const std::string written = options_.samples ? "" : writer.Write(result, failures);
        if (!learnedLights_->SavePath().empty() && !result.cancelled)
            Collect(failures, [&] { learnedLights_->Save(built); });
        timings_.write = progress_.EndPhase();
        const bool hasFailed = checkpoint_ && !checkpoint_->Failure().empty();
        if (settings_->checkpoint && !hasFailed) LogCheckpoint(result);
        if (!written.empty())
            LogInfo("Wrote {} ({} per pixel, {:.2f} s; {:.2f} s since the start).", written,
                    CountText(result.samplesTaken, "sample"), result.seconds, timings_.Total());
        if (!written.empty() && !result.cancelled) LogNoise(result);
        if (options_.stats == "text") PrintStatistics(built, result, timings_);
        if (options_.stats == "text" && team_.Size() > 1)
            std::printf("  %-34s %d, %d; %.3f MB sent\n", "processes, threads", team_.Size(), team_.TotalThreads(),
                        double(sent) / 1e6);
        if (options_.stats == "json") PrintStatisticsJson(options_, built, result, timings_, written);
        std::fflush(stdout);
        live_.WaitForViewers(LiveView::kFarewellSeconds);
        if (!result.mseFailure.empty()) failures.Error({}, result.mseFailure);
        if (hasFailed) failures.Error({}, checkpoint_->Failure());
        failures.ThrowIfErrors();
        signals_.EndAtOnce("");
        return signals_.Status();
    }

    void LogNoise(const RenderResult &result) const {
        if (!result.adaptive) return;
        const std::optional<double> &noise = result.adaptive->noise;
        if (noise) LogInfo("Estimated noise: {:.4f}.", *noise);
        if (options_.noise > 0 && (!noise || *noise > options_.noise))
            LogWarning("--noise {} was not reached: {}; raise --spp or --time.", options_.noise,
                       noise ? fmt::format("it takes about {:.0f} samples per pixel",
                                           SamplesForNoise(result.samplesTaken, *noise, options_.noise))
                             : "there are too few samples for an estimate");
    }

    void LogCheckpoint(const RenderResult &result) const {
        const RenderFileHead &head = checkpoint_->Head();
        if (result.cancelled)
            LogInfo("{} holds what was rendered; rerun the command with --resume to resume.", checkpoint_->Path());
        else if (head.isPart)
            LogInfo("Wrote {} (samples {}:{} of {}, {:.2f} s); imgtool merge makes the image.", checkpoint_->Path(),
                    head.first, head.end, head.samplesPerBatch, result.seconds);
    }

    const CommandLine &options_;
    const PluginRegistry &registry_;
    Team &team_;
    Progress &progress_;
    SignalWatch &signals_;
    LiveView &live_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    Timings timings_{.startUp = SecondsSinceProcessStart()};
    DiagnosticSink sink_;
    size_t printed_ = 0;  ///< printed diagnostics of sink_
    BuildOptions build_;
    std::optional<LearnedLights> learnedLights_;
    std::optional<Checkpoint> checkpoint_;
    std::string shared_;                  ///< storage of learned_ on other ranks
    std::optional<StateReader> learned_;  ///< from the checkpoint or the learned lights
    std::optional<BuiltScene> built_;
    std::optional<RenderSettings> settings_;
};

}  // namespace

int RunRenderJob(const CommandLine &options, const PluginRegistry &registry, Team &team, Progress &progress,
                 SignalWatch &signals, LiveView &live) {
    if (options.memoryLimit > 0) LimitMemory(options.memoryLimit);
    return RenderJob(options, registry, team, progress, signals, live).Run();
}

}  // namespace pbrt
