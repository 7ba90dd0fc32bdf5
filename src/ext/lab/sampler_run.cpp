#include "ext/lab/sampler_run.h"

#include <algorithm>
#include <cmath>

#include "pbrt/core/log.h"

namespace ext::lab {
namespace {

constexpr double kLongestWave = 1;  ///< seconds; clock and progress are updated between waves only

void LoadFilm(const std::string &file, Film &film) {
    const std::string bytes = ReadFileContents(file);
    StateReader in(bytes, file);
    film.Load(in);
}

}  // namespace

SamplerRun::SamplerRun(const LabScene &scene, const SamplerChoice &choice, int seed, int expectedSamples,
                       Progress &cancel, std::optional<int> maxDepth)
    : scene_(scene), label_(choice.label), cancel_(cancel), integrator_(scene.MakeIntegrator(choice, maxDepth)),
      film_(scene.built.film->MakeRgbFilm()), sampler_(scene.built.sampler->WithSeed(seed)),
      settings_(scene.built.Settings()),
      renderer_({*integrator_, *scene.built.camera, *scene.built.filter, *film_, *sampler_, cancel}, settings_) {
    sampler_->SkipSamples(int64_t{seed % kSeeds} * expectedSamples);
    record_.seed = seed;
    record_.expectedSamples = expectedSamples;
}

bool SamplerRun::Prepare() {
    PrepareContext context = scene_.built.Preparation(cancel_);
    context.seed = record_.seed;
    context.samplesPerPixel = record_.expectedSamples;
    ResetCounters();
    Stopwatch watch;
    integrator_->Prepare(context);
    record_.prepare = watch.Elapsed();
    record_.prepareShadowRays = SumCounters().shadowRays;
    now_.spent = record_.prepare;
    return !cancel_.Cancelled();
}

void SamplerRun::Resume(const RunRecord &record, const std::string &filmFile) {
    LoadFilm(filmFile, *film_);
    record_ = record;
    now_ = record.rounds.back();
    renderer_.ContinueFrom(now_.samples);
    secondsPerSample_ = record.SecondsPerSample();
}

bool SamplerRun::RenderTo(const RenderTarget &target, const std::function<void()> &afterWave) {
    const bool timed = target.seconds > 0;
    for (;;) {
        int size = 1;
        if (renderer_.Done() > 0) {
            double fits = kLongestWave / std::max(secondsPerSample_, 1e-6);
            if (timed) fits = std::min(fits, (target.seconds - now_.spent.wall) / secondsPerSample_ + 0.5);
            size = std::clamp(int(fits), timed ? 0 : 1, kMaxWave);
        }
        if (!timed) size = std::min(size, target.samples - renderer_.Done());
        if (size < 1) return true;
        ResetCounters();
        Stopwatch watch;
        const int taken = renderer_.Render(size);
        if (taken == 0) return false;
        const TimeSpent wave = watch.Elapsed();
        now_.spent.wall += wave.wall;
        now_.spent.cpu += wave.cpu;
        secondsPerSample_ = wave.wall / taken;
        const RenderCounters counters = SumCounters();
        now_.shadowRays += counters.shadowRays;
        now_.shadowRaysBlocked += counters.shadowRaysBlocked;
        if (afterWave) afterWave();
    }
}

void SamplerRun::AddRound(int checkpoint, const Measures &measures) {
    now_.checkpoint = checkpoint;
    now_.samples = Samples();
    now_.measures = measures;
    record_.rounds.push_back(now_);
    record_.report = Json::object();
    if (const LightSampler *lights = integrator_->Lights()) {
        lights->Report(record_.report);
        record_.structure = lights->DescribeStructure();
    }
}

ImageMetadata SamplerRun::Metadata() const {
    ImageMetadata m = scene_.Metadata(*film_, label_, Samples(), Spent().wall);
    m.attributes["lightlab.prepareSeconds"] = float(record_.prepare.wall);
    m.attributes["lightlab.seed"] = record_.seed;
    return m;
}

void SamplerRun::SaveFilm(const std::string &path) const {
    StateWriter out;
    film_->Save(out);
    WriteFile(path, out.Pieces());
}

bool IsFinite(const Image &picture) {
    bool isFinite = true;
    ForEachValue(picture, [&](Point2i p, int c) { isFinite = isFinite && std::isfinite(picture.Get(p, c)); });
    return isFinite;
}

bool IsWholeImage(const std::string &file, Point2i resolution) {
    if (!FileExists(file)) return false;
    try {
        const Image picture = ReadImage(file).image.Select({"R", "G", "B"});
        return picture.Resolution() == resolution && IsFinite(picture);
    } catch (const UserError &) {
        return false;
    }
}

RunRecord LoadResumableRun(const RecordFolder &records, const LabScene &scene, const std::string &sampler, int seed,
                           size_t checkpoints, const std::string &picture) {
    RunRecord run = records.LoadRun(sampler, seed, checkpoints);
    auto canResume = [&](size_t rounds) {
        if (rounds == checkpoints) return IsWholeImage(picture, scene.Resolution());
        DiagnosticSink ignored;
        const std::string film = records.FilmFile(sampler, seed, int(rounds) - 1);
        return Collect(ignored, [&] { LoadFilm(film, *scene.built.film->MakeRgbFilm()); });
    };
    size_t kept = run.rounds.size();
    while (kept > 0 && !canResume(kept)) --kept;
    if (records.CountRounds(sampler, seed, checkpoints) > kept)
        LogWarning("{}/{}: records of seed {} are damaged or missing; {}.", records.Folder(), sampler, seed,
                   kept > 0
                       ? fmt::format("resuming from {} per pixel", CountText(run.rounds[kept - 1].samples, "sample"))
                       : "restarting this run");
    // Reports and structure must be those of the last kept round.
    if (kept < run.rounds.size()) run = records.LoadRun(sampler, seed, kept);
    records.RemoveRounds(sampler, seed, kept, checkpoints);
    return run;
}

}  // namespace ext::lab
