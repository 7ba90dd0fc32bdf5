#include "ext/lab/experiment.h"

#include <algorithm>
#include <filesystem>
#include <tuple>

#include "ext/lab/pictures.h"
#include "ext/lab/results.h"
#include "ext/lab/sampler_run.h"
#include "pbrt/core/log.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/version.h"
#include "pbrt/math/statistics.h"

namespace ext::lab {
namespace {

namespace fs = std::filesystem;

constexpr int kWarmUpSeed = 700003;
constexpr int kReliableSamples = 4;

std::string SelectionNote(const SamplerChoice &choice) { return choice.folder + "/selection.json"; }

/// Creates the folders. An existing experiment is resumed if its settings match; else throws UserError.
void OpenFolder(const ExperimentSettings &settings, const Json &identity, const RecordFolder &records) {
    const std::string &out = settings.outFolder;
    if (fs::exists(out) && !fs::is_directory(out)) throw UserError("{}: is a file, not a folder.", out);
    if (settings.restart) fs::remove_all(records.Folder());
    const Json old = records.LoadSettings();
    if (old.is_discarded()) {
        LogWarning("{}: cannot be read; records that belong to these settings are used.",
                   records.File("settings.json"));
    } else if (old.is_object()) {
        if (std::vector<std::string> differences = Differences(old, identity); !differences.empty())
            throw UserError(
                "{} holds an experiment with other settings ({}). Choose another --out, or --restart to replace it.",
                out, fmt::join(differences, "; "));
        LogInfo("{} holds records of this experiment; resuming from them.", out);
    }
    for (const SamplerChoice &s : settings.samplers)
        for (const std::string &folder : {records.Folder(), out}) MakeFolder(folder + "/" + s.folder);
    records.SaveSettings(identity);
}

/// Renders the runs of an experiment: seed by seed, all samplers in turns from checkpoint to checkpoint.
class Rounds {
  public:
    Rounds(const ExperimentContext &context, const References &references)
        : context_(context), settings_(context.settings), ofSampler_(references.ofSampler),
          checkpoints_(Checkpoints(settings_)), hasPilot_(!references.pilot.empty()) {
        for (const Reference &r : references.all) measuring_.emplace_back(r.image);
        if (!settings_.samplesFrom.empty()) replay_ = SampleCounts::Read(settings_.samplesFrom, settings_);
        if (replay_) checkpoints_.resize(replay_->checkpoints);
        for (const SamplerChoice &s : settings_.samplers)
            cost_.push_back(hasPilot_ ? SecondsPerSample(references.pilot, s) : 1);
    }

    /// Returns false if cancelled.
    bool RenderAll() {
        if (!FindExpectedSamples()) return false;
        recordsOf_.assign(settings_.samplers.size(), {});
        for (size_t i = 0; i < settings_.samplers.size(); ++i)
            for (int seed = 0; seed < settings_.seeds; ++seed) {
                recordsOf_[i].push_back(LoadResumableRun(context_.records, context_.scene, settings_.samplers[i].folder,
                                                         seed, checkpoints_.size(), PictureFile(i, seed)));
                const RunRecord &record = recordsOf_[i].back();
                if (!record.rounds.empty()) LearnCost(i, record.rounds.back().samples, record.SecondsPerSample());
            }
        context_.display.SetPhase("rendering");
        context_.display.SetAfter(0);
        for (int seed = 0; seed < settings_.seeds; ++seed) {
            std::vector<std::unique_ptr<SamplerRun>> runs(settings_.samplers.size());
            for (size_t c = 0; c < checkpoints_.size(); ++c)
                for (size_t i = 0; i < runs.size(); ++i) {
                    RunRecord &record = recordsOf_[i][seed];
                    if (record.rounds.size() > c) continue;
                    if (!runs[i] && !(runs[i] = Start(i, seed, record))) return false;
                    if (!RenderTo(i, seed, c, *runs[i])) return false;
                    record = runs[i]->Record();
                    if (c + 1 < checkpoints_.size()) continue;
                    // Not earlier: samplers that learn during rendering would learn from the queries of views and
                    // check.
                    if (seed == 0 && !Examine(i, runs[i].get())) return false;
                    runs[i].reset();
                }
        }
        for (size_t i = 0; i < settings_.samplers.size(); ++i)
            if (!Examine(i, nullptr)) return false;
        return true;
    }
    std::vector<std::vector<RunRecord>> TakeRecords() { return std::move(recordsOf_); }
    size_t CheckpointCount() const { return checkpoints_.size(); }
    std::string PictureFile(size_t i, int seed) const {
        return fmt::format("{}/{}/seed{}.exr", settings_.outFolder, settings_.samplers[i].folder, seed);
    }

  private:
    /// Inspects a sampler and checks its light selection, after its first run. `run`: that run, or null if finished in
    /// an earlier session. Returns false if cancelled.
    bool Examine(size_t i, SamplerRun *run) { return InspectSampler(i, run) && Check(i, run); }

    /// Writes the inspection views of a sampler once.
    bool InspectSampler(size_t i, SamplerRun *run) {
        if (!settings_.views || HasViews(context_, i)) return true;
        std::unique_ptr<SamplerRun> again;
        if (!run && !(run = (again = Prepared(i, 0, expected_[i])).get())) return false;
        // A guide learns from the samples.
        if (again && run->GetIntegrator().Directions() && !run->RenderTo({expected_[i], 0})) return false;
        return WriteViews(context_, i, run->GetIntegrator());
    }

    /// Checks a sampler's light selection once. Skips the oracle, which is not ranked and would take hours.
    bool Check(size_t i, SamplerRun *run) {
        const SamplerChoice &choice = settings_.samplers[i];
        if (!(settings_.selectionWork > 0) || choice.traits.isInstrument) return true;
        // An undecided check is repeated if more work is allowed.
        if (const Json note = context_.records.LoadNote(SelectionNote(choice));
            note.is_object() &&
            (note.at("verdict") != BiasVerdictName(BiasVerdict::Unknown) || note.at("work") >= settings_.selectionWork))
            return true;
        std::unique_ptr<SamplerRun> again;
        if (!run && !(run = (again = Prepared(i, 0, expected_[i])).get())) return false;
        SelectionSettings how;
        how.maxWork = settings_.selectionWork;
        how.bias.level = SidakLevel(how.bias.level, settings_.samplers.size());
        if (!vertices_) vertices_.emplace(SelectionVertices::Measure(context_.scene.built, how.seed, context_.cancel));
        if (context_.cancel.Cancelled()) return false;
        const std::optional<SelectionReport> report =
            CheckSelection(*vertices_, *run->GetIntegrator().Lights(), how, context_.cancel);
        if (!report) return false;
        Json note = ToJson(*report);
        note["work"] = how.maxWork;
        context_.records.SaveNote(SelectionNote(choice), note);
        return true;
    }

    /// Null if cancelled.
    std::unique_ptr<SamplerRun> Prepared(size_t i, int seed, int expected) {
        auto run = std::make_unique<SamplerRun>(context_.scene, settings_.samplers[i], seed, expected, context_.cancel);
        return run->Prepare() ? std::move(run) : nullptr;
    }

    std::unique_ptr<SamplerRun> Start(size_t i, int seed, const RunRecord &record) {
        if (record.rounds.empty()) return Prepared(i, seed, expected_[i]);
        auto run = Prepared(i, seed, record.expectedSamples);
        const int last = record.rounds.back().checkpoint;
        if (run) run->Resume(record, context_.records.FilmFile(settings_.samplers[i].folder, seed, last));
        return run;
    }

    bool RenderTo(size_t i, int seed, size_t checkpoint, SamplerRun &run) {
        const std::string &folder = settings_.samplers[i].folder;
        auto afterWave = [&] {
            if (run.SecondsPerSample() > 0) LearnCost(i, run.Samples(), run.SecondsPerSample());
            const double sinceRecord = SecondsOf(i, run.Samples(), run.Spent()) - SecondsDone(i, seed);
            context_.display.Show(std::max(0.0, SecondsLeft() - sinceRecord));
        };
        if (!run.RenderTo(TargetOf(i, seed, checkpoint), afterWave)) return false;
        const Image picture = run.Picture();
        const int c = int(checkpoint);
        run.AddRound(c, measuring_[ofSampler_[i]].Compare(picture));
        // The record is written last: a round without record does not count.
        const bool last = checkpoint + 1 == checkpoints_.size();
        if (last) WriteImage(PictureFile(i, seed), picture, run.Metadata());
        else run.SaveFilm(context_.records.FilmFile(folder, seed, c));
        context_.records.SaveLastRound(folder, run.Record());
        if (checkpoint > 0) fs::remove(context_.records.FilmFile(folder, seed, c - 1));
        return true;
    }

    /// Sets expected_, the planned samples per pixel of every sampler. With a time budget it is an estimate
    /// (FittingSamples), from the pilot or a run of two samples, which also warms up the machine. Stored in the
    /// records, because images may depend on it. Returns false if cancelled.
    bool FindExpectedSamples() {
        Json note = context_.records.LoadNote("expected-samples.json");
        if (!note.is_object()) note = Json::object();
        for (size_t i = 0; i < settings_.samplers.size(); ++i) {
            const std::string &label = settings_.samplers[i].label;
            int expected = note.value(label, settings_.samplesPerPixel);
            if (replay_) expected = replay_->expected.at(label);
            else if (settings_.Timed() && !note.contains(label)) {
                if (!hasPilot_) {
                    const auto run = Prepared(i, kWarmUpSeed, context_.scene.Batch());
                    if (!run || !run->RenderTo({2, 0})) return false;
                    cost_[i] = run->SecondsPerSample();
                }
                expected = FittingSamples(settings_.timeBudget, cost_[i]);
            }
            note[label] = expected;
            expected_.push_back(expected);
        }
        context_.records.SaveNote("expected-samples.json", note);
        return true;
    }

    RenderTarget TargetOf(size_t i, int seed, size_t checkpoint) const {
        if (replay_) return {replay_->runs.at({settings_.samplers[i].label, seed}).at(checkpoint), 0};
        return checkpoints_[checkpoint];
    }

    /// Seconds of one run; by samples, at the current cost estimate.
    double SecondsOf(size_t i, int samples, const TimeSpent &spent) const {
        return replay_ || !settings_.Timed() ? samples * cost_[i] : std::min(spent.wall, settings_.timeBudget);
    }
    double SecondsDone(size_t i, int seed) const {
        const RunRecord &record = recordsOf_[i][seed];
        return record.rounds.empty() ? 0 : SecondsOf(i, record.rounds.back().samples, record.rounds.back().spent);
    }
    double SecondsLeft() const {
        double left = 0;
        for (size_t i = 0; i < settings_.samplers.size(); ++i)
            for (int seed = 0; seed < settings_.seeds; ++seed) {
                const int samples = TargetOf(i, seed, checkpoints_.size() - 1).samples;
                left += SecondsOf(i, samples, {settings_.timeBudget, 0}) - SecondsDone(i, seed);
            }
        return left;
    }
    /// A run's first samples fill caches and cells; the pilot's estimate is better.
    void LearnCost(size_t i, int samples, double secondsPerSample) {
        const bool wasInPilot = hasPilot_ && !settings_.samplers[i].traits.isInstrument;
        if (samples >= kReliableSamples || !wasInPilot) cost_[i] = secondsPerSample;
    }

    const ExperimentContext &context_;
    const ExperimentSettings &settings_;
    const std::vector<size_t> &ofSampler_;
    std::vector<RenderTarget> checkpoints_;
    std::optional<SampleCounts> replay_;
    std::vector<MeasuringReference> measuring_;
    const bool hasPilot_;
    std::vector<double> cost_;  ///< seconds per sample
    std::vector<int> expected_;
    std::vector<std::vector<RunRecord>> recordsOf_;
    std::optional<SelectionVertices> vertices_;  ///< for light selection checks; created on first use
};

Json Header(const ExperimentSettings &settings, const LabScene &scene, const Json &identity, size_t checkpoints) {
    const std::string program = VersionText();
    const size_t version = program.find(' ') + 1, end = program.find(" (commit "), commit = end + 9;
    Json json = {{"schema", kResultsSchema},
                 {"scene", settings.scene},
                 {"sceneName", fs::path(settings.scene).stem().string()},
                 {"sceneHash", scene.hash},
                 {"version", program.substr(version, end - version)},
                 {"commit", program.substr(commit, program.size() - commit - 1)},
                 {"commandLine", settings.commandLine},
                 {"date", DateText()},
                 {"machine", DescribeMachine()},
                 {"mode", settings.Timed() ? "time" : "samples"},
                 {"budget", settings.Timed() ? Json(settings.timeBudget) : Json(settings.samplesPerPixel)},
                 {"seeds", settings.seeds},
                 {"resolution", {scene.Resolution().x, scene.Resolution().y}},
                 {"maxDepth", scene.built.maxDepth},
                 {"direct", scene.built.maxDepth == 1},
                 {"settings", identity}};
    json["settings"]["checkpoints"] = checkpoints;
    json["settings"]["batch"] = scene.Batch();
    return json;
}

void CheckCrops(const ExperimentSettings &settings, const LabScene &scene) {
    const Point2i resolution = scene.Resolution();
    for (const Bounds2i &c : settings.crops)
        if (c.IsEmpty() || Intersect(c, {{0, 0}, resolution}).Area() < c.Area())
            throw UserError("--crops: {},{},{},{} is not inside the image of {} x {} pixels.", c.low.x, c.low.y,
                            c.high.x, c.high.y, resolution.x, resolution.y);
}

}  // namespace

std::vector<RenderTarget> Checkpoints(const ExperimentSettings &settings) {
    std::vector<RenderTarget> list = {{1, 0}};
    if (settings.Timed()) {
        for (double divisor = 64; divisor >= 1; divisor /= 2) list.push_back({0, settings.timeBudget / divisor});
    } else {
        for (int64_t samples = 2; samples < settings.samplesPerPixel; samples *= 2) list.push_back({int(samples), 0});
        if (settings.samplesPerPixel > 1) list.push_back({settings.samplesPerPixel, 0});
    }
    return list;
}

std::optional<ExperimentOutcome> RunExperiment(const ExperimentSettings &settings, const PluginRegistry &registry,
                                               Progress &cancel, ProgressSink *sink) {
    const LabScene scene = LoadLabScene(settings, registry, cancel);
    CheckCrops(settings, scene);
    DiagnosticSink errors;  // of the samplers' parameters, before anything is rendered
    for (const SamplerChoice &choice : settings.samplers) Collect(errors, [&] { scene.MakeIntegrator(choice); });
    errors.ThrowIfErrors();
    if (!settings.referenceFile.empty())
        ReadReference(settings.referenceFile, scene);  // throws if it does not match the film
    for (const auto &[flag, input, output] : {std::tuple("--reference", settings.referenceFile, "/reference-0.exr"),
                                              std::tuple("--samples-from", settings.samplesFrom, "/results.json")})
        if (!input.empty() && IsSameFile(input, settings.outFolder + output))
            throw UserError("{} {}: the experiment in {} would overwrite this file; choose another --out.", flag, input,
                            settings.outFolder);
    const Json identity = IdentityOf(settings, scene.hash, ThreadCount());
    const RecordFolder records(settings.outFolder + "/records", ExperimentKey(identity));
    OpenFolder(settings, identity, records);

    ExperimentDisplay display(sink, cancel);
    const ExperimentContext context{settings, scene, registry, records, cancel, display};
    const std::optional<References> references = MakeReferences(context);
    if (!references) return {};
    Rounds rounds(context, *references);
    if (!rounds.RenderAll()) return {};
    display.Finish();

    std::vector<std::vector<Image>> pictures(settings.samplers.size());
    std::vector<std::optional<SelectionReport>> selections(settings.samplers.size());
    for (size_t i = 0; i < pictures.size(); ++i) {
        for (int seed = 0; seed < settings.seeds; ++seed)
            pictures[i].push_back(ReadImage(rounds.PictureFile(i, seed)).image.Select({"R", "G", "B"}));
        const Json note = records.LoadNote(SelectionNote(settings.samplers[i]));
        if (settings.selectionWork > 0 && note.is_object()) selections[i] = SelectionFromJson(note);
    }
    ExperimentOutcome outcome;
    outcome.results = Header(settings, scene, identity, rounds.CheckpointCount());
    WritePictures(context, *references, pictures, &outcome.results);
    const ExperimentResults results = Summarize(settings, *references, rounds.TakeRecords(), pictures, selections);
    AddToJson(results, &outcome.results);
    AddViews(context, &outcome.results);
    ShortenFloats(&outcome.results);
    outcome.text = TableText(results, *references);
    WriteFile(settings.outFolder + "/results.csv", SummaryCsv(results));
    WriteFile(settings.outFolder + "/rounds.csv", RoundsCsv(results));
    WriteFile(settings.outFolder + "/results.json", outcome.results.dump(1) + "\n");
    return outcome;
}

}  // namespace ext::lab
