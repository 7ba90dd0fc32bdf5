#include "ext/lab/reference.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "ext/lab/bias_check.h"
#include "ext/lab/sampler_run.h"
#include "pbrt/core/error.h"
#include "pbrt/images/metrics.h"

namespace ext::lab {

namespace {

constexpr int kParts = 8;           // seeds of a reference; their scatter estimates its noise (7 degrees of freedom)
constexpr int kFirstSeed = 800001;  // disjoint from the seeds of runs and pilot
constexpr int kSeedStep = 1000;     // between references
constexpr int kMinSamples = 64;     // by time
constexpr double kDisagree = 2;     // factor on the relL2 explained by the noise of two references

class ReferenceMaker {
  public:
    ReferenceMaker(const ExperimentSettings &settings, const LabScene &scene, const RecordFolder &records,
                   Progress &cancel, ExperimentDisplay &display)
        : settings_(settings), scene_(scene), records_(records), cancel_(cancel), display_(display),
          rule_(ReferenceRule::For(settings)) {}

    /// Returns nothing if cancelled.
    std::optional<Reference> Make(const PilotEntry &with, int index) {
        const int firstSeed = kFirstSeed + index * kSeedStep;
        const std::string about =
            fmt::format("sampler {}; {}; {} parts from seed {}", with.choice.label, rule_.Text(), kParts, firstSeed);
        ReferenceCache cache(settings_, scene_, about);
        if (std::optional<Reference> found = cache.Find()) return found;

        Reference reference;
        reference.sampler = with.choice.label;
        const int samples = SamplesPerPart(with, index);
        reference.samples = samples * kParts;
        display_.SetPhase(fmt::format("reference {}", index));
        std::vector<std::string> files;
        for (int part = 0; part < kParts; ++part) {
            files.push_back(records_.File(fmt::format("reference-{}-part{}.exr", cache.Key(), part + 1)));
            if (!RenderPart(with.choice, firstSeed + part, samples, kParts - 1 - part, files.back(), &reference))
                return {};
        }
        AverageParts(&reference);
        cache.Store(scene_, about, &reference);
        for (const std::string &file : files) std::filesystem::remove(file);
        return reference;
    }

  private:
    /// With a time budget, from the cost measured by the pilot; recorded, so that a resumed experiment uses the same
    /// number. A replay uses the number of the original experiment.
    int SamplesPerPart(const PilotEntry &with, int index) const {
        if (rule_.samples > 0) return (rule_.samples + kParts - 1) / kParts;
        if (!settings_.samplesFrom.empty())
            for (const Json &r : ReadResults(settings_.samplesFrom).at("references"))
                if (r.value("sampler", "") == with.choice.label && r.value("samples", 0) > 0)
                    return (r.value("samples", 0) + kParts - 1) / kParts;
        const std::string note = fmt::format("reference-{}.json", index);
        Json known = records_.LoadNote(note);
        if (known.is_object() && known.value("sampler", "") == with.choice.label)
            return known.value("samplesPerPart", 1);
        const double fit = rule_.seconds / std::max(1e-6, with.secondsPerSample);
        const int samples = static_cast<int>(std::ceil(std::max<double>(kMinSamples, fit) / kParts));
        records_.SaveNote(note, {{"sampler", with.choice.label}, {"samplesPerPart", samples}});
        return samples;
    }

    bool RenderPart(const SamplerChoice &choice, int seed, int samples, int partsAfter, const std::string &file,
                    Reference *reference) {
        if (IsWholePicture(file, scene_.Resolution())) {
            ImageFile known = ReadImage(file);
            if (const auto *seconds = std::get_if<float>(&known.metadata.attributes["renderTimeSeconds"]))
                reference->seconds += double(*seconds);
            reference->parts.push_back(known.image.Select({"R", "G", "B"}));
            return true;
        }
        SamplerRun run(scene_, choice, seed, samples, cancel_);
        if (!run.Prepare()) return false;
        auto afterWave = [&] {
            const double samplesLeft = samples * (1.0 + partsAfter) - run.Samples();
            display_.Show(samplesLeft * run.SecondsPerSample());
        };
        if (!run.RenderTo({samples, 0}, afterWave)) return false;
        WriteImage(file, run.Picture(), run.Metadata());
        reference->parts.push_back(run.Picture());
        reference->seconds += run.Spent().wall;
        return true;
    }

    const ExperimentSettings &settings_;
    const LabScene &scene_;
    const RecordFolder &records_;
    Progress &cancel_;
    ExperimentDisplay &display_;
    ReferenceRule rule_;
};

bool Contradict(const Reference &a, const Reference &b) {
    auto means = [](const Reference &r) {
        std::vector<TileMeans> tiles;
        for (const Image &part : r.parts) tiles.push_back(ComputeTileMeans(part));
        return tiles;
    };
    return CheckBias(means(a), BiasReference{means(b), {}}).verdict == BiasVerdict::Biased;
}

References GivenReference(const ExperimentSettings &settings, const LabScene &scene) {
    References references;
    references.all.push_back(ReadReference(settings.referenceFile, scene));
    references.ofSampler.assign(settings.samplers.size(), 0);
    const std::string &maker = references.all[0].sampler;
    for (const SamplerChoice &s : settings.samplers)
        if (!maker.empty() && s.label == maker)
            references.doubts.push_back(
                {fmt::format("{} was rendered with \"{}\", which is compared here: its own errors are partly in the "
                             "reference, so its measured error is too low.",
                             settings.referenceFile, maker),
                 s.label});
    return references;
}

}  // namespace

std::optional<Doubt> Disagreement(const Reference &a, const Reference &b, bool areStocks, bool *proveNoBias) {
    *proveNoBias = areStocks && (Contradict(a, b) || Contradict(b, a));
    const double apart =
        std::max(ImageError(a.image, b.image, Metric::RelL2), ImageError(b.image, a.image, Metric::RelL2));
    const double expected = a.noise.value_or(0) + b.noise.value_or(0);
    const std::string both = fmt::format("the references of \"{}\" and \"{}\"", a.sampler, b.sampler);
    if (*proveNoBias)
        return Doubt{fmt::format("One of {} lacks light that its sampler meets rarely: they contradict each other, so "
                                 "they prove no bias and rank no sampler. More --reference-spp is needed.",
                                 both),
                     ""};
    if (!(apart > kDisagree * expected)) return {};
    return Doubt{
        fmt::format(
            "The samplers are not judged alike: {} differ by relL2 {:.3g}, and their noise explains {:.3g}. The second "
            "judges \"{}\" only. More --reference-spp is needed.",
            both, apart, expected, a.sampler),
        ""};
}

ReferenceRule ReferenceRule::For(const ExperimentSettings &settings) {
    if (settings.referenceSamples > 0) return {settings.referenceSamples, 0};
    if (settings.Timed()) return {0, 10 * settings.timeBudget};
    return {std::max(512, 16 * settings.samplesPerPixel), 0};
}

std::string ReferenceRule::Text() const {
    return samples > 0 ? CountText(samples, "sample") + " per pixel" : fmt::format("{} s", seconds);
}

std::optional<References> MakeReferences(const ExperimentSettings &settings, const LabScene &scene,
                                         const PluginRegistry &registry, const RecordFolder &records, Progress &cancel,
                                         ExperimentDisplay &display) {
    if (!settings.referenceFile.empty()) return GivenReference(settings, scene);
    const std::optional<std::vector<PilotEntry>> pilot = RunPilot(settings, scene, registry, records, cancel, display);
    if (!pilot) return {};

    auto isListed = [&](const SamplerChoice &c) {
        return std::any_of(settings.samplers.begin(), settings.samplers.end(),
                           [&](const SamplerChoice &s) { return s.label == c.label; });
    };
    ReferenceMaker maker(settings, scene, records, cancel, display);
    References references;
    std::vector<PilotEntry> makers = *pilot;
    bool areStocks = false;
    for (bool stockOnly : {false, true}) {
        if (stockOnly) std::erase_if(makers, [&](const PilotEntry &e) { return !IsTrusted(e.choice); });
        references.all.clear();
        const size_t wanted = (stockOnly || isListed(makers.at(0).choice)) && makers.size() > 1 ? 2 : 1;
        for (size_t i = 0; i < wanted; ++i) {
            double after = EstimateRuns(settings, *pilot);
            for (size_t k = i + 1; k < wanted; ++k)
                after += ReferenceRule::For(settings).EstimateSeconds(makers[k].secondsPerSample);
            display.SetAfter(after);
            std::optional<Reference> made = maker.Make(makers[i], static_cast<int>(i));
            if (!made) return {};
            references.all.push_back(std::move(*made));
        }
        areStocks = std::all_of(makers.begin(), makers.begin() + wanted,
                                [&](const PilotEntry &e) { return IsTrusted(e.choice); });
        if (wanted < 2 || areStocks || !Contradict(references.all[0], references.all[1])) break;
        references.remarks.push_back(fmt::format(
            "The references of \"{}\" and \"{}\" contradict each other: one is biased. Stock's samplers made "
            "the references instead.",
            makers[0].choice.label, makers[1].choice.label));
    }
    if (references.all.size() > 1) {
        if (std::optional<Doubt> doubt =
                Disagreement(references.all[0], references.all[1], areStocks, &references.areDoubtful))
            references.doubts.push_back(*doubt);
    }
    for (const SamplerChoice &s : settings.samplers)
        references.ofSampler.push_back(s.label == references.all[0].sampler && references.all.size() > 1 ? 1 : 0);
    return references;
}

}  // namespace ext::lab
