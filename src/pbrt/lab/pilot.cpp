#include "pbrt/lab/pilot.h"

#include <algorithm>
#include <cmath>

#include "pbrt/lab/reference.h"
#include "pbrt/lab/sampler_run.h"

namespace pbrt::lab {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kSamples = 4;         // per picture; two pictures a candidate
constexpr int kFirstSeed = 700001;  // far from the seeds of the runs
constexpr double kTrimmed = 0.001;

std::vector<SamplerChoice> Candidates(const CampaignSettings &settings, const LabScene &scene,
                                      const LightSamplerRegistry &registry) {
    std::vector<SamplerChoice> candidates;
    for (const SamplerChoice &s : settings.samplers)
        if (!s.IsOracle()) candidates.push_back(s);
    for (std::string stock : {"bvh", "uniform"}) {
        if (!scene.built.shadowGateName.empty()) stock += "+gate=none";
        auto isListed = [&](const SamplerChoice &s) { return s.label == stock; };
        if (std::none_of(candidates.begin(), candidates.end(), isListed))
            candidates.push_back(ParseSamplerChoices({stock}, registry).front());
    }
    return candidates;
}

/// Variance of one sample, relative as in relL2, from two pictures of kSamples samples.
double Variance(const Image &a, const Image &b, const std::vector<double> &mean) {
    const Point2i resolution = a.Resolution();
    std::vector<double> terms;
    size_t i = 0;
    for (int y = 0; y < resolution.y; ++y)
        for (int x = 0; x < resolution.x; ++x) {
            double sum = 0;
            for (int c = 0; c < 3; ++c, ++i) {
                const double d = double(a.Get({x, y}, c)) - double(b.Get({x, y}, c));
                sum += d * d / 2 / (mean[i] * mean[i] + 0.01);
            }
            terms.push_back(sum / 3);
        }
    std::sort(terms.begin(), terms.end());
    terms.resize(terms.size() - static_cast<size_t>(std::ceil(kTrimmed * static_cast<double>(terms.size()))));
    double sum = 0;
    for (double t : terms) sum += t;
    return terms.empty() ? 0 : kSamples * sum / static_cast<double>(terms.size());
}

Json ToJson(const std::vector<PilotEntry> &entries) {
    Json json = Json::array();
    for (const PilotEntry &e : entries)
        json.push_back(
            {{"sampler", e.choice.label}, {"variance", e.variance}, {"secondsPerSample", e.secondsPerSample}});
    return json;
}

/// Entries from the note of an earlier session; empty if it does not fit.
std::vector<PilotEntry> FromJson(const Json &json, const std::vector<SamplerChoice> &candidates) {
    std::vector<PilotEntry> entries;
    if (!json.is_array()) return {};
    for (const Json &e : json)
        for (const SamplerChoice &c : candidates)
            if (c.label == e.value("sampler", ""))
                entries.push_back({c, e.value("variance", 0.0), e.value("secondsPerSample", 0.0)});
    return entries.size() == candidates.size() ? entries : std::vector<PilotEntry>{};
}

}  // namespace

double MeanSecondsPerSample(const std::vector<PilotEntry> &entries) {
    double sum = 0;
    for (const PilotEntry &e : entries) sum += e.secondsPerSample;
    return entries.empty() ? 0 : sum / static_cast<double>(entries.size());
}

double EstimateRuns(const CampaignSettings &settings, const std::vector<PilotEntry> &entries) {
    double seconds = 0;
    for (const SamplerChoice &s : settings.samplers) {
        auto known = std::find_if(entries.begin(), entries.end(),
                                  [&](const PilotEntry &e) { return e.choice.label == s.label; });
        const double cost = known == entries.end() ? MeanSecondsPerSample(entries) : known->secondsPerSample;
        seconds += settings.Timed() ? settings.timeBudget : settings.samplesPerPixel * cost;
    }
    return seconds * settings.seeds;
}

bool IsTrusted(const SamplerChoice &choice, const LabScene &scene) {
    const bool stock =
        choice.name == "uniform" || choice.name == "power" || choice.name == "bvh" || choice.name == "exhaustive";
    return stock && (choice.gate == "none" || (choice.gate.empty() && scene.built.shadowGateName.empty()));
}

std::optional<std::vector<PilotEntry>> RunPilot(const CampaignSettings &settings, const LabScene &scene,
                                                const LightSamplerRegistry &registry, const RecordFolder &records,
                                                Progress &cancel, CampaignDisplay &display) {
    const std::vector<SamplerChoice> candidates = Candidates(settings, scene, registry);
    if (std::vector<PilotEntry> known = FromJson(records.LoadNote("pilot.json"), candidates); !known.empty())
        return known;

    display.SetPhase("pilot");
    std::vector<PilotEntry> entries;
    double left = -1;  // the first candidate tells how fast the machine is
    std::vector<std::array<Image, 2>> pictures;
    std::vector<double> mean(3 * static_cast<size_t>(scene.Pixels().Area()), 0.0);
    const int expected = settings.Timed() ? scene.Batch() : settings.samplesPerPixel;
    for (const SamplerChoice &candidate : candidates) {
        PilotEntry entry{candidate, 0, 1e30};
        std::array<Image, 2> pair;
        for (int k = 0; k < 2; ++k) {
            SamplerRun run(scene, candidate, kFirstSeed + k, expected, cancel);
            if (!run.Prepare() || !run.RenderTo({kSamples, 0}, [&] { display.Show(left); })) return {};
            const double seconds = run.Spent().wall - run.Record().prepare.wall;
            entry.secondsPerSample = std::min(entry.secondsPerSample, seconds / kSamples);
            pair[static_cast<size_t>(k)] = run.Picture();
        }
        size_t i = 0;
        for (int y = 0; y < pair[0].Resolution().y; ++y)
            for (int x = 0; x < pair[0].Resolution().x; ++x)
                for (int c = 0; c < 3; ++c, ++i)
                    mean[i] += (double(pair[0].Get({x, y}, c)) + double(pair[1].Get({x, y}, c))) /
                               (2 * static_cast<double>(candidates.size()));
        entries.push_back(entry);
        const double perSample = MeanSecondsPerSample(entries);
        left = static_cast<double>(candidates.size() - entries.size()) * 2 * kSamples * perSample;
        display.SetAfter(2 * ReferenceRule::For(settings).EstimateSeconds(perSample) + EstimateRuns(settings, entries));
        pictures.push_back(std::move(pair));
    }
    for (size_t i = 0; i < entries.size(); ++i) entries[i].variance = Variance(pictures[i][0], pictures[i][1], mean);
    std::stable_sort(entries.begin(), entries.end(),
                     [](const PilotEntry &a, const PilotEntry &b) { return a.variance < b.variance; });
    records.SaveNote("pilot.json", ToJson(entries));
    return entries;
}

}  // namespace pbrt::lab
