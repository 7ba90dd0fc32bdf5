#include <cmath>

#include "ext/lab/reference.h"
#include "ext/lab/sampler_run.h"
#include "ext/lab/tile_statistics.h"
#include "pbrt/images/metrics.h"

namespace ext::lab {
namespace {

constexpr int kMinPilotSamples = 4, kMaxPilotSamples = 16;  // per image; two images per candidate
constexpr int kShareOfReference = 128;                      // all candidates together take some 6 % of two references
constexpr int kPilotSeed = 700001;                          // disjoint from the seeds of the runs

std::vector<SamplerChoice> Candidates(const ExperimentSettings &settings, const PluginRegistry &registry) {
    std::vector<SamplerChoice> candidates;
    for (const SamplerChoice &s : settings.samplers)
        if (!s.traits.isInstrument) candidates.push_back(s);
    for (const char *stock : {"bvh", "uniform"})
        if (std::ranges::find(candidates, stock, &SamplerChoice::label) == candidates.end())
            candidates.push_back(ParseSamplerChoices({stock}, registry).front());
    return candidates;
}

/// More samples for many lights per pixel (lights never selected leave no trace), and for long references.
int SamplesPerImage(const ExperimentSettings &settings, const LabScene &scene) {
    const double lights = double(scene.built.scene->Lights().Size());
    const double pixels = double(std::max<int64_t>(1, scene.Pixels().Area()));
    const int forReference = ReferenceRule::For(settings).samples / kShareOfReference;
    return std::clamp(std::max(int(8 * lights / pixels), forReference), kMinPilotSamples, kMaxPilotSamples);
}

/// Two images of a candidate and their common tile means.
struct Pilot {
    std::array<Image, 2> pictures;
    TileMeans tiles;

    explicit Pilot(std::array<Image, 2> pair) : pictures(std::move(pair)), tiles(ComputeTileMeans(pictures[0])) {
        const TileMeans second = ComputeTileMeans(pictures[1]);
        for (size_t i = 0; i < tiles.values.size(); ++i) tiles.values[i] = (tiles.values[i] + second.values[i]) / 2;
    }
};

/// Variance of one sample, relative as in relL2, from the differences of the candidate's two images. Denominators are
/// tile means of the other candidates: a rare bright sample must not enlarge its own divisor, which would favour the
/// sampler with the rarest ones. `epsilon`: RelL2Epsilon of all candidates' mean.
double VarianceBetweenImages(const std::vector<Pilot> &pilots, size_t which, int samples, double epsilon) {
    const auto &[a, b] = pilots[which].pictures;
    double sum = 0;
    pilots[which].tiles.grid.ForEachTile([&](int tile, const Bounds2i &pixels) {
        for (int c = 0; c < 3; ++c) {
            double others = 0, squares = 0;
            for (size_t k = 0; k < pilots.size(); ++k)
                if (k != which) others += pilots[k].tiles(tile, c);
            others /= double(pilots.size() - 1);
            ForEachPixel(pixels, [&](int x, int y) {
                const double d = double(a.Get({x, y}, c)) - double(b.Get({x, y}, c));
                if (std::isfinite(d)) squares += d * d / 2;
            });
            sum += squares / (others * others + epsilon);
        }
    });
    return samples * sum / (3 * double(a.Resolution().x) * double(a.Resolution().y));
}

/// The same from the squared differences of the candidate's tiles to the mean of the others, minus that mean's noise.
/// Detects light so rare that neither of its images contains it. `between`: VarianceBetweenImages of all.
double VarianceAgainstOthers(const std::vector<Pilot> &pilots, size_t which, int samples,
                             const std::vector<double> &between, double epsilon) {
    // Noisy candidates count less. None counts more than the median one, as one that misses a light seems quiet.
    std::vector<double> sorted = between, weights(between.size(), 0);
    std::sort(sorted.begin(), sorted.end());
    double total = 0, noise = 0;
    for (size_t k = 0; k < pilots.size(); ++k)
        if (k != which) total += weights[k] = 1 / std::max({between[k], sorted[sorted.size() / 2], 1e-9});
    for (size_t k = 0; k < pilots.size(); ++k) noise += between[k] * weights[k] * weights[k] / (total * total);

    double sum = 0, area = 0;
    pilots[which].tiles.grid.ForEachTile([&](int tile, const Bounds2i &bounds) {
        const auto pixels = double(bounds.Area());
        for (int c = 0; c < 3; ++c) {
            double others = 0;
            for (size_t k = 0; k < pilots.size(); ++k) others += weights[k] / total * pilots[k].tiles(tile, c);
            const double d = pilots[which].tiles(tile, c) - others;
            sum += pixels * pixels * d * d / (others * others + epsilon);
            area += pixels;
        }
    });
    return 2 * samples * sum / area - noise;
}

/// Entries from an earlier session's note; empty if it does not match.
std::vector<PilotEntry> FromJson(const Json &json, const std::vector<SamplerChoice> &candidates) {
    std::vector<PilotEntry> entries;
    if (!json.is_array()) return {};
    for (const Json &e : json)
        for (const SamplerChoice &c : candidates)
            if (c.label == e.value("sampler", ""))
                entries.push_back({c, e.value("variance", 0.0), e.value("secondsPerSample", 0.0)});
    return entries.size() == candidates.size() ? entries : std::vector<PilotEntry>{};
}

double MeanSecondsPerSample(const std::vector<PilotEntry> &entries) {
    double sum = 0;
    for (const PilotEntry &e : entries) sum += e.secondsPerSample;
    return entries.empty() ? 0 : sum / double(entries.size());
}

}  // namespace

double SecondsPerSample(const std::vector<PilotEntry> &entries, const SamplerChoice &choice) {
    for (const PilotEntry &e : entries)
        if (e.choice.label == choice.label) return e.secondsPerSample;
    return MeanSecondsPerSample(entries);
}

double EstimateRuns(const ExperimentSettings &settings, const std::vector<PilotEntry> &entries) {
    double seconds = 0;
    for (const SamplerChoice &s : settings.samplers)
        seconds += settings.Timed() ? settings.timeBudget : settings.samplesPerPixel * SecondsPerSample(entries, s);
    return seconds * settings.seeds;
}

std::optional<std::vector<PilotEntry>> RunPilot(const ExperimentContext &context) {
    const auto &[settings, scene, registry, records, cancel, display] = context;
    const std::vector<SamplerChoice> candidates = Candidates(settings, registry);
    if (std::vector<PilotEntry> known = FromJson(records.LoadNote("pilot.json"), candidates); !known.empty())
        return known;

    display.SetPhase("pilot");
    const int samples = SamplesPerImage(settings, scene);
    std::vector<PilotEntry> entries;
    double left = -1;  // unknown before the first candidate is rendered
    std::vector<Pilot> pilots;
    const int expected = settings.Timed() ? scene.Batch() : settings.samplesPerPixel;
    for (const SamplerChoice &candidate : candidates) {
        PilotEntry entry{candidate, 0, 1e30};
        std::array<Image, 2> pair;
        for (int k = 0; k < 2; ++k) {
            SamplerRun run(scene, candidate, kPilotSeed + k, expected, cancel);
            if (!run.Prepare() || !run.RenderTo({samples, 0}, [&] { display.Show(left); })) return {};
            const double seconds = run.Spent().wall - run.Record().prepare.wall;
            entry.secondsPerSample = std::min(entry.secondsPerSample, seconds / samples);
            pair[k] = run.Picture();
        }
        entries.push_back(entry);
        const double perSample = MeanSecondsPerSample(entries);
        left = double(candidates.size() - entries.size()) * 2 * samples * perSample;
        display.SetAfter(2 * ReferenceRule::For(settings).EstimateSeconds(perSample) + EstimateRuns(settings, entries));
        pilots.emplace_back(std::move(pair));
    }
    double mean = 0;
    for (const Pilot &p : pilots)
        for (const double v : p.tiles.values) mean += v / double(pilots.size() * p.tiles.values.size());
    const double epsilon = RelL2Epsilon(mean);
    std::vector<double> between;
    for (size_t i = 0; i < pilots.size(); ++i) between.push_back(VarianceBetweenImages(pilots, i, samples, epsilon));
    for (size_t i = 0; i < pilots.size(); ++i)
        entries[i].variance = std::max(between[i], VarianceAgainstOthers(pilots, i, samples, between, epsilon));
    std::ranges::stable_sort(entries, {}, &PilotEntry::variance);
    Json note = Json::array();
    for (const PilotEntry &e : entries)
        note.push_back(
            {{"sampler", e.choice.label}, {"variance", e.variance}, {"secondsPerSample", e.secondsPerSample}});
    records.SaveNote("pilot.json", note);
    return entries;
}

}  // namespace ext::lab
