#include "pbrt/cmd/pbrt/render_job.h"

#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "pbrt/build/built_scene.h"
#include "pbrt/cmd/pbrt/checkpoint.h"
#include "pbrt/cmd/pbrt/image_output.h"
#include "pbrt/cmd/pbrt/learned_lights.h"
#include "pbrt/cmd/pbrt/run_report.h"
#include "pbrt/core/count_text.h"
#include "pbrt/core/counters.h"
#include "pbrt/core/files.h"
#include "pbrt/core/log.h"
#include "pbrt/core/memory.h"
#include "pbrt/core/parallel.h"
#include "pbrt/images/picture_name.h"
#include "pbrt/integrators/render_loop.h"
#include "pbrt/scenefile/parser.h"

namespace pbrt {

namespace {

/// Seconds that the writing of a picture may go on after a signal. Longer than any disk needs, shorter than schedulers
/// wait before they kill a process.
constexpr double kWritingSeconds = 10;

/// While somebody watches, waves are kept that short, so that the picture is seen to grow. Shorter ones would cost
/// more: samples of a pixel that are taken one after the other share work.
constexpr double kLiveWaveSeconds = 3;

LiveRender LiveRenderOf(const CommandLine &options, const BuiltScene &built, const RenderSettings &settings) {
    LiveRender live;
    live.scene = fmt::format("{}", fmt::join(SceneFilesOf(options), " "));
    live.filename = built.filename;
    live.fullResolution = built.film->FullResolution();
    live.pixelBounds = built.film->PixelBounds();
    live.timeBudget = options.timeBudget;
    if (options.timeBudget <= 0) live.samples = settings.EndSample();
    return live;
}

void PrintWarnings(const DiagnosticSink &sink, size_t *printed) {
    bool color = isatty(STDERR_FILENO) != 0;
    const std::vector<Diagnostic> &all = sink.All();
    for (; *printed < all.size(); ++*printed)
        if (all[*printed].severity == Severity::Warning) LogInfo(Format(all[*printed], color));
}

/// Pictures beside the main one are in the memory of one process until its end.
void CheckSidePictures(const CommandLine &options, const BuiltScene &built, const Team &team) {
    if (!built.integrator->MakesSidePictures()) return;
    if (!options.checkpoint.empty() || team.Size() > 1)
        throw UserError(
            "\"visualizestrategies\" and \"visualizeweights\" exclude --checkpoint, --samples and mpirun: what single "
            "strategies found is neither kept in checkpoints nor sent to other processes.");
}

std::string NothingWritten(const std::string &phase) {
    return fmt::format("Interrupted while {}: no image was written.", phase);
}

/// The picture of one render on its way to its file.
class PictureWriter {
  public:
    PictureWriter(const CommandLine &options, const BuiltScene &built, const Timings &timings, SignalWatch &signals)
        : options_(options), built_(built), timings_(timings), signals_(signals), output_(built.filename) {}

    /// After a wave, while the render goes on. A failure is only a warning, because the final picture is what counts.
    void WritePartial(const RenderResult &result) {
        try {
            SayWriting(output_.Filename());
            output_.WriteUnfinished(built_.film->ToImage(), Describe(result));
        } catch (const UserError &e) {
            LogWarning(fmt::format("the image after {} per pixel was not written; rendering goes on. {}",
                                   CountText(result.samplesTaken, "sample"), e.Diagnostics()[0].message));
        }
        SayRendering();
    }

    /// At the end. False: there is nothing to write.
    bool Write(const RenderResult &result) {
        if (result.cancelled && result.samplesTaken == 0) {
            LogInfo("Interrupted before every pixel had a sample: no image was written.");
            return false;
        }
        SayWriting(output_.Filename());
        std::string name = output_.Filename();
        if (result.cancelled)
            name = output_.WriteUnfinished(built_.film->ToImage(), Describe(result));
        else
            output_.WriteFinished(built_.film->ToImage(), Describe(result));
        for (const SidePicture &side : built_.integrator->SidePictures()) {
            const std::string beside = WithSuffix(name, "-" + side.name);
            SayWriting(beside);
            WriteImage(beside, side.film->ToImage(), Describe(result));
        }
        if (result.cancelled) LogInfo("Interrupted: the image holds what was rendered.");
        if (name != output_.Filename())
            LogInfo(fmt::format("{} is kept: it has more samples of this scene, or an unknown number of them.",
                                output_.Filename()));
        written_ = name;
        return true;
    }
    const std::string &Written() const { return written_; }

    void SayRendering() const {
        signals_.Cancel("Interrupted; what was rendered is being saved. A second signal ends at once.",
                        "Interrupted again: the last samples were not saved.", SignalWatch::kForever);
    }

  private:
    void SayWriting(const std::string &name) const {
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
    std::string written_;
};

/// Prepares the integrator: by what was learned before, from a file of learned lights, or by finding everything out.
void PrepareLights(std::optional<StateReader> reader, const LearnedLights &lights, BuiltScene &built, Team &team,
                   Progress &progress) {
    PrepareContext context = built.Preparation(progress, team);
    if (!reader && lights.AreLoaded()) {
        reader.emplace(lights.Learned());
        context.learnsOn = false;
    }
    if (reader) context.learned = &*reader;
    built.integrator->Prepare(context);
    // A file of learned lights may have more than this integrator uses.
    if (reader && context.learnsOn) reader->RequireEnd();
}

/// mpirun gives its standard input to the first process only.
void RefusePipes(const CommandLine &options) {
    for (const std::string &file : SceneFilesOf(options))
        if (file == "-")
            throw UserError("under mpirun the scene must be in files: only one process gets the standard input.");
}

/// Only the first process reads the checkpoint; the others get from it what they need. There `learned` then refers to
/// `memory`.
void ShareCheckpoint(Team &team, BuildOptions *build, std::optional<StateReader> *learned, std::string *memory) {
    if (team.Size() == 1) return;
    team.Meet();
    StateWriter out;
    if (team.IsRank0()) {
        out.Value(build->samplesPerPixel);
        out.Value(learned->has_value());
        if (*learned) {
            StateReader all = **learned;
            const std::string_view bytes = all.Take(all.BytesLeft());
            out.Refer(bytes.data(), bytes.size());
        }
    }
    *memory = team.Broadcast(out);
    if (team.IsRank0()) return;
    StateReader in(*memory, "the checkpoint");
    in.Value(&build->samplesPerPixel);
    if (in.Value<bool>()) *learned = StateReader(in.Take(in.BytesLeft()), "the checkpoint");
}

/// Sets the number of samples per pixel to what --time allows by a measurement of the first process, so that everything
/// that depends on it (prepass, guide, pixel sampler) is as with the fitting --spp. `start`: of the budget.
void PlanSamples(double budget, std::chrono::steady_clock::time_point start, Team &team, BuiltScene &built) {
    int samples = 0;
    if (team.IsRank0()) {
        const auto left = [&] {
            return budget - std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        };
        const std::unique_ptr<Integrator> plain = MakePlainIntegrator(built);
        Progress silent;
        PrepareContext context = built.Preparation(silent);
        plain->Prepare(context);
        const std::unique_ptr<Film> scratch = built.film->MakeRgbFilm();
        double perSample = MeasureSecondsPerSample(
            {*plain, *built.camera, *built.filter, *scratch, *built.sampler, silent}, built.Settings(), left());
        perSample *= static_cast<double>(ThreadCount()) / team.TotalThreads();
        samples = FittingSamples(left(), perSample);
    }
    team.Meet();
    samples = team.BroadcastValue(samples);
    built.SetSamples(samples);
    LogInfo(fmt::format("--time {}: prepared for {} per pixel, as by --spp {}.", budget, CountText(samples, "sample"),
                        samples));
}

/// Brings all counters to the first process, and how many bytes were sent.
void ReduceCounters(Team &team, uint64_t *sent) {
    *sent = team.BytesSent();
    team.Reduce(
        [&](StateWriter &out) {
            out.Value(SumCounters());
            out.Value(*sent);
        },
        [&](StateReader &in) {
            AddCounters(in.Value<RenderCounters>());
            *sent += in.Value<uint64_t>();
        });
}

/// What the processes beside the first do in place of all that follows the preparation.
int FollowRender(BuiltScene &built, Team &team, const RenderSettings &settings, Progress &progress,
                 SignalWatch &signals) {
    signals.Cancel("", "", SignalWatch::kForever);
    FollowWaves(built.Rendering(progress, team), settings);
    uint64_t sent = 0;
    ReduceCounters(team, &sent);
    signals.EndAtOnce("");
    return signals.Status();
}

void SayKept(const Checkpoint &checkpoint, const RenderResult &result) {
    const RenderFileHead &head = checkpoint.Head();
    if (result.cancelled)
        LogInfo(fmt::format("{} holds what was rendered; the same command with --resume goes on.", checkpoint.Path()));
    else if (head.isPart)
        LogInfo(fmt::format("Wrote {} (samples {}:{} of {}, {:.2f} s); imgtool merge makes the picture.",
                            checkpoint.Path(), head.first, head.end, head.samplesPerBatch, result.seconds));
}

}  // namespace

int RunRenderJob(const CommandLine &options, const PluginRegistry &registry, Team &team, Progress &progress,
                 SignalWatch &signals, LiveView &live) {
    if (options.memoryLimit > 0) LimitMemory(options.memoryLimit);
    const bool isFirst = team.IsRank0();
    const auto start = std::chrono::steady_clock::now();
    Timings timings;
    timings.startUp = SecondsSinceProcessStart();
    DiagnosticSink sink;
    size_t printed = 0;

    signals.EndAtOnce(NothingWritten("reading"));
    if (team.Size() > 1) RefusePipes(options);
    progress.BeginPhase("reading", 0);
    SceneDescription description = ParseSceneFiles(SceneFilesOf(options), sink);
    PrintWarnings(sink, &printed);
    sink.ThrowIfErrors();
    BuildOptions build = options.build;
    build.checksOutput = build.checksOutput && isFirst;
    const LearnedLights learnedLights(options);
    // In world coordinates the lights of all frames of an animation are the same, wherever the camera is.
    if (learnedLights.AreUsed() && build.renderCoordSys.empty() && !description.options.renderCoordSys)
        build.renderCoordSys = "world";
    std::optional<Checkpoint> checkpoint;
    if (!options.checkpoint.empty() && isFirst) checkpoint.emplace(options, description, learnedLights.Hash(), &build);
    std::optional<StateReader> learned;
    if (checkpoint && checkpoint->IsResumed()) learned.emplace(checkpoint->Learned());
    std::string shared;
    ShareCheckpoint(team, &build, &learned, &shared);
    // Here and below, a signal that comes after the line "done" belongs to the phase that follows.
    signals.EndAtOnce(NothingWritten("building"));
    timings.read = progress.EndPhase();

    progress.BeginPhase("building", 0);
    BuiltScene built = [&] {
        try {
            return BuildScene(description, build, registry, sink, progress);
        } catch (...) {
            PrintWarnings(sink, &printed);
            throw;
        }
    }();
    description.shapes.clear();
    PrintWarnings(sink, &printed);
    learnedLights.Check(built);
    CheckSidePictures(options, built, team);
    team.Meet();
    signals.EndAtOnce(NothingWritten("preparing lights"));
    timings.build = progress.EndPhase();

    if (options.build.quick)
        LogInfo(fmt::format(
            "--quick: {} x {} pixels{}.", built.film->FullResolution().x, built.film->FullResolution().y,
            options.timeBudget > 0 ? "" : fmt::format(", {} per pixel", CountText(built.samplesPerPixel, "sample"))));

    progress.BeginPhase("preparing lights", 0);
    // A render that goes on has its number of samples from the checkpoint. Only light samplers and guides learn.
    if (options.timeBudget > 0 && !learned && built.integrator->Lights())
        PlanSamples(options.timeBudget, start, team, built);
    RenderSettings settings = built.Settings();
    settings.timeBudget = options.timeBudget;
    settings.start = start;
    PrepareLights(learned, learnedLights, built, team, progress);
    timings.prepare = progress.EndPhase();
    if (checkpoint) checkpoint->Begin(built, &settings);
    ResetCounters();
    team.Meet();
    team.EndMeetings();
    if (!isFirst) return FollowRender(built, team, settings, progress, signals);

    RenderResult result;
    PictureWriter writer(options, built, timings, signals);
    if (options.writePartialImages || live.HasViewers())
        settings.afterWave = [&](int samples) {
            // The last picture comes with the end of the render.
            if (options.timeBudget <= 0 && samples == settings.EndSample()) return;
            if (live.HasViewers())
                settings.maxWaveSeconds = std::max(kLiveWaveSeconds, live.AfterWave(*built.film, samples));
            if (!options.writePartialImages) return;
            result.samplesTaken = samples;
            writer.WritePartial(result);
        };
    if (live.HasViewers()) {
        settings.maxWaveSeconds = kLiveWaveSeconds;
        live.Begin(LiveRenderOf(options, built, settings));
    }
    // Without its preparation there would be nothing to go on from.
    if (checkpoint && !progress.Cancelled()) {
        settings.checkpointInterval = options.checkpointInterval;
        settings.checkpoint = [&](const RenderPosition &position) {
            RenderResult until;
            until.samplesTaken = position.done;
            checkpoint->Write(built, position, DescribeImage(options, built, until, timings));
        };
    }
    const bool isPart = options.samples.has_value();
    writer.SayRendering();
    result = RenderWaves(built.Rendering(progress, team), settings);
    uint64_t sent = 0;
    ReduceCounters(team, &sent);
    timings.render = result.seconds;
    if (checkpoint) result.seconds += checkpoint->RenderSecondsBefore();
    live.Finish(*built.film, result.samplesTaken, result.cancelled);
    progress.BeginPhase("writing", 0);
    const bool isWritten = !isPart && writer.Write(result);
    if (!learnedLights.SavePath().empty() && !result.cancelled) learnedLights.Save(built);
    timings.write = progress.EndPhase();
    if (checkpoint && settings.checkpoint && checkpoint->Failure().empty()) SayKept(*checkpoint, result);
    if (isWritten)
        LogInfo(fmt::format("Wrote {} ({} per pixel, {:.2f} s; {:.2f} s since the start).", writer.Written(),
                            CountText(result.samplesTaken, "sample"), result.seconds, timings.Total()));
    if (options.stats == "text") PrintStatistics(built, result, timings);
    if (options.stats == "text" && team.Size() > 1)
        std::printf("  %-34s %d, %d; %.3f MB sent\n", "processes, threads", team.Size(), team.TotalThreads(),
                    static_cast<double>(sent) / 1e6);
    if (options.stats == "json")
        PrintStatisticsJson(options, built, result, timings, isWritten ? writer.Written() : std::string());
    std::fflush(stdout);
    live.SayFarewell();
    // The picture is written all the same.
    if (!result.mseFailure.empty()) throw UserError(result.mseFailure);
    if (checkpoint && !checkpoint->Failure().empty()) throw UserError(checkpoint->Failure());
    // Only memory is left to be freed.
    signals.EndAtOnce("");
    return signals.Status();
}

}  // namespace pbrt
