#include "ext/lab/reference.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "ext/lab/sampler_run.h"
#include "pbrt/core/log.h"
#include "pbrt/scenefile/content_hash.h"

namespace ext::lab {
namespace {

namespace fs = std::filesystem;

constexpr int kParts = 8;           // seeds of a reference; their scatter estimates its noise (7 degrees of freedom)
constexpr int kFirstSeed = 800501;  // disjoint from the seeds of runs and pilot, also modulo SamplerRun::kSeeds
constexpr int kSeedStep = 1000;     // between references; below SamplerRun::kSeeds
constexpr int kMinSamples = 64;     // by time
constexpr int kMaxSamples = 1 << 30;
constexpr double kDisagree = 2;  // factor on the relL2 explained by the noise of two references

std::string PartChannel(size_t part, int color) { return fmt::format("part{}.{}", part + 1, "RGB"[color]); }

/// A reference without images, from the metadata of its file.
Reference Described(const std::string &path, const ImageMetadata &m) {
    Reference reference;
    reference.hasLabel = m.attributes.contains("lightlab.sampler");
    reference.sampler = m.Attribute<std::string>(reference.hasLabel ? "lightlab.sampler" : "lightSampler").value_or("");
    reference.samples = m.Attribute<int>("samplesPerPixel").value_or(0);
    reference.seconds = double(m.Attribute<float>("renderTimeSeconds").value_or(0));
    reference.source = path;
    return reference;
}

/// Throws UserError if the file has an attribute of this type and name with another value than the experiment's.
template <class T>
void RequireEqual(const std::string &path, const ImageMetadata &file, const ImageMetadata &own, const char *name) {
    const std::optional<T> has = file.Attribute<T>(name);
    const T needs = own.Attribute<T>(name).value();
    if (has && *has != needs)
        throw UserError("{}: the reference was rendered with {} {}; this experiment has {}.", path, name, *has, needs);
}

/// Sets `image` to the mean of the parts and, if there are several, `noise`.
void AverageParts(Reference *reference) {
    MeanImage mean = AverageImages(reference->parts);
    reference->image = std::move(mean.image);
    if (reference->parts.size() > 1) reference->noise = mean.noise;
}

/// Hash of all that ReadCached reads. `about`: as in ReferenceCache.
std::string HashOf(const Reference &r, const std::string &about) {
    ContentHash hash(fmt::format("{}; {}; {}; {}", about, r.sampler, r.samples, float(r.seconds)));
    const auto add = [&](const Image &image) {
        hash.Add(std::string(static_cast<const char *>(image.Data()), image.Bytes()));
    };
    add(r.image);
    for (const Image &part : r.parts) add(part);
    return hash.Hex();
}

/// Empty if the file is not this reference as it was stored.
std::optional<Reference> ReadCached(const std::string &path, Point2i resolution, const std::string &about) {
    const ImageFile file = ReadImage(path);
    Reference reference = Described(path, file.metadata);
    if (file.metadata.Attribute<int>("lightlab.parts") != kParts || file.image.Resolution() != resolution) return {};
    reference.image = file.image.Select({"R", "G", "B"});
    for (int part = 0; part < kParts; ++part) {
        reference.parts.push_back(
            file.image.Select({PartChannel(part, 0), PartChannel(part, 1), PartChannel(part, 2)}));
        reference.parts.back().RenameChannels({"R", "G", "B"});
    }
    if (file.metadata.Attribute<std::string>("lightlab.hash") != HashOf(reference, about)) return {};
    AverageParts(&reference);
    if (!IsFinite(reference.image)) return {};
    return reference;
}

/// The file of one reference in the cache; see MakeReferences.
class ReferenceCache {
  public:
    /// `about`: sampler, rule and seeds as text, part of the hash.
    ReferenceCache(const ExperimentSettings &settings, const LabScene &scene, const std::string &about)
        : scene_(scene), about_(about) {
        const Bounds2i &pixels = scene.Pixels();
        ContentHash hash(
            fmt::format("reference 3; scene {}; {}x{}, pixels {} {} {} {}; depth {}; batch {}; jitter {} {}; {}",
                        scene.hash, scene.FullResolution().x, scene.FullResolution().y, pixels.low.x, pixels.low.y,
                        pixels.high.x, pixels.high.y, scene.built.maxDepth, scene.Batch(),
                        scene.built.disablePixelJitter, scene.built.disableWavelengthJitter, about));
        if (settings.sampledLightOnly) hash.Add("sampled light");
        key_ = hash.Hex();
        const std::string name = fmt::format("{}.reference-{}.exr", fs::path(settings.scene).stem().string(), key_);
        if (!settings.cacheFolder.empty()) files_.push_back((fs::path(settings.cacheFolder) / name).string());
        files_.push_back((fs::path(settings.outFolder) / name).string());
    }
    const std::string &Key() const { return key_; }

    /// Files that are unreadable or changed give a warning and count as absent.
    std::optional<Reference> Find() const {
        for (const std::string &path : files_) {
            if (!FileExists(path)) continue;
            try {
                if (std::optional<Reference> found = ReadCached(path, scene_.Resolution(), about_)) return found;
                LogWarning("{}: is not the reference that belongs there; it is rendered again.", path);
            } catch (const UserError &e) {
                LogWarning("{} The reference is rendered again.", e.what());
            }
        }
        return {};
    }

    /// Sets reference.source. A cache folder that is not writable gives a warning, an output folder an error.
    void Store(Reference *reference) const {
        const std::vector<Image> &parts = reference->parts;
        std::vector<std::string> channels = {"R", "G", "B"};
        for (size_t part = 0; part < parts.size(); ++part)
            for (int c = 0; c < 3; ++c) channels.push_back(PartChannel(part, c));
        Image all(PixelFormat::Float, reference->image.Resolution(), channels);
        ForEachPixel(all.Resolution(), [&](int x, int y) {
            for (int c = 0; c < all.ChannelCount(); ++c)
                all.Set({x, y}, c, (c < 3 ? reference->image : parts[c / 3 - 1]).Get({x, y}, c % 3));
        });
        ImageMetadata m =
            scene_.Metadata(*scene_.built.film, reference->sampler, reference->samples, reference->seconds);
        m.attributes["lightlab.parts"] = int(parts.size());
        m.attributes["lightlab.reference"] = about_;
        m.attributes["lightlab.hash"] = HashOf(*reference, about_);
        m.attributes["lightlab.noiseRelL2"] = float(reference->noise.value_or(0));
        m.attributes["lightlab.date"] = DateText();
        for (const std::string &path : files_) {
            try {
                std::error_code error;
                fs::create_directories(fs::path(path).parent_path(), error);
                WriteImage(path, all, m);
                reference->source = path;
                return;
            } catch (const std::exception &e) {
                if (&path == &files_.back()) throw;
                LogWarning(
                    "{}: the reference cannot be kept there ({}); it is kept in the output folder. --cache DIR chooses "
                    "another place.",
                    path, e.what());
            }
        }
    }

  private:
    const LabScene &scene_;
    std::string about_, key_;
    std::vector<std::string> files_;  ///< in search and write order
};

/// With a time budget, from the cost measured by the pilot; recorded, so that a resumed experiment uses the same
/// number. A replay uses the number of the original experiment.
int SamplesPerPart(const ExperimentContext &context, const PilotEntry &with, int index) {
    const ReferenceRule rule = ReferenceRule::For(context.settings);
    if (rule.samples > 0) return (rule.samples + kParts - 1) / kParts;
    if (!context.settings.samplesFrom.empty())
        for (const Json &r : ReadResults(context.settings.samplesFrom).at("references"))
            if (r.value("sampler", "") == with.choice.label && r.value("samples", 0) > 0)
                return (r.value("samples", 0) + kParts - 1) / kParts;
    const std::string note = fmt::format("reference-{}.json", index);
    const Json known = context.records.LoadNote(note);
    if (known.is_object() && known.value("sampler", "") == with.choice.label) return known.value("samplesPerPart", 1);
    const double fit = rule.seconds / std::max(1e-6, with.secondsPerSample);
    const int samples = int(std::ceil(std::clamp<double>(fit, kMinSamples, kMaxSamples) / kParts));
    context.records.SaveNote(note, {{"sampler", with.choice.label}, {"samplesPerPart", samples}});
    return samples;
}

/// Reads the next part if it is finished, or renders it; adds it to the reference. Parts have seeds of their own, and
/// otherwise are consecutive samples of one render. Returns false if cancelled.
bool AddPart(const ExperimentContext &context, const SamplerChoice &choice, int firstSeed, int samples,
             const std::string &file, Reference *reference) {
    const int part = int(reference->parts.size());
    if (IsWholeImage(file, context.scene.Resolution())) {
        const ImageFile known = ReadImage(file);
        reference->seconds += Described(file, known.metadata).seconds;
        reference->parts.push_back(known.image.Select({"R", "G", "B"}));
        return true;
    }
    SamplerRun run(context.scene, choice, firstSeed + part, samples, context.cancel);
    run.ContinueAfter(part * samples);
    const auto afterWave = [&] {
        const double samplesLeft = samples * double(kParts - part) - run.Samples();
        context.display.Show(samplesLeft * run.SecondsPerSample());
    };
    if (!run.Prepare() || !run.RenderTo({samples, 0}, afterWave)) return false;
    WriteImage(file, run.Picture(), run.Metadata());
    reference->parts.push_back(run.Picture());
    reference->seconds += run.Spent().wall;
    return true;
}

/// Returns nothing if cancelled.
std::optional<Reference> MakeReference(const ExperimentContext &context, const PilotEntry &with, int index) {
    const int firstSeed = kFirstSeed + index * kSeedStep;
    const ReferenceCache cache(context.settings, context.scene,
                               fmt::format("sampler {}; {}; {} parts from seed {}", with.choice.label,
                                           ReferenceRule::For(context.settings).Text(), kParts, firstSeed));
    if (std::optional<Reference> found = cache.Find()) return found;

    Reference reference;
    reference.sampler = with.choice.label;
    const int samples = SamplesPerPart(context, with, index);
    reference.samples = samples * kParts;
    context.display.SetPhase(fmt::format("reference {}", index));
    std::vector<std::string> files;
    for (int part = 0; part < kParts; ++part) {
        files.push_back(context.records.File(fmt::format("reference-{}-part{}.exr", cache.Key(), part + 1)));
        if (!AddPart(context, with.choice, firstSeed, samples, files.back(), &reference)) return {};
    }
    AverageParts(&reference);
    cache.Store(&reference);
    for (const std::string &file : files) fs::remove(file);
    return reference;
}

bool Contradict(const Reference &a, const Reference &b) {
    return CheckBias(TilesOf(a.parts), BiasReference{TilesOf(b.parts), {}}).verdict == BiasVerdict::Biased;
}

References GivenReference(const ExperimentSettings &settings, const LabScene &scene) {
    References references;
    const Reference &given = references.all.emplace_back(ReadReference(settings.referenceFile, scene));
    references.ofSampler.assign(settings.samplers.size(), 0);
    for (const SamplerChoice &s : settings.samplers)
        if ((given.hasLabel ? s.label : s.name) == given.sampler)
            references.doubts.push_back(
                {fmt::format("{} was rendered with \"{}\", which is compared here: errors in common are not measured.",
                             settings.referenceFile, given.sampler),
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
    if (settings.referenceSamples > 0) return {std::min(settings.referenceSamples, kMaxSamples), 0};
    if (settings.Timed()) return {0, 10 * settings.timeBudget};
    return {int(std::clamp<int64_t>(16 * int64_t{settings.samplesPerPixel}, 512, kMaxSamples)), 0};
}

std::string ReferenceRule::Text() const {
    return samples > 0 ? CountText(samples, "sample") + " per pixel" : fmt::format("{} s", seconds);
}

std::vector<PilotEntry> RankMakers(const ExperimentSettings &settings, std::vector<PilotEntry> entries) {
    const bool atEqualTime = ReferenceRule::For(settings).samples == 0;
    std::ranges::stable_sort(entries, {},
                             [&](const PilotEntry &e) { return e.variance * (atEqualTime ? e.secondsPerSample : 1); });
    if (settings.samplesFrom.empty()) return entries;
    std::vector<std::string> originals;
    for (const Json &r : ReadResults(settings.samplesFrom).at("references"))
        originals.push_back(r.value("sampler", ""));
    std::ranges::stable_sort(entries, {}, [&](const PilotEntry &e) {
        return std::ranges::find(originals, e.choice.label) - originals.begin();
    });
    return entries;
}

std::optional<References> MakeReferences(const ExperimentContext &context) {
    const ExperimentSettings &settings = context.settings;
    if (!settings.referenceFile.empty()) return GivenReference(settings, context.scene);
    const std::optional<std::vector<PilotEntry>> pilot = RunPilot(context);
    if (!pilot) return {};

    auto isListed = [&](const SamplerChoice &c) {
        return std::ranges::find(settings.samplers, c.label, &SamplerChoice::label) != settings.samplers.end();
    };
    References references;
    references.pilot = *pilot;
    std::vector<PilotEntry> makers = RankMakers(settings, *pilot);
    bool areStocks = false;  // the images of stock's samplers are considered unbiased
    for (bool stockOnly : {false, true}) {
        if (stockOnly) std::erase_if(makers, [&](const PilotEntry &e) { return !e.choice.traits.isStock; });
        references.all.clear();
        const size_t wanted = (stockOnly || isListed(makers.at(0).choice)) && makers.size() > 1 ? 2 : 1;
        for (size_t i = 0; i < wanted; ++i) {
            double after = EstimateRuns(settings, *pilot);
            for (size_t k = i + 1; k < wanted; ++k)
                after += ReferenceRule::For(settings).EstimateSeconds(makers[k].secondsPerSample);
            context.display.SetAfter(after);
            std::optional<Reference> made = MakeReference(context, makers[i], int(i));
            if (!made) return {};
            references.all.push_back(std::move(*made));
        }
        areStocks = std::all_of(makers.begin(), makers.begin() + wanted,
                                [&](const PilotEntry &e) { return e.choice.traits.isStock; });
        if (wanted < 2 || areStocks || !Contradict(references.all[0], references.all[1])) break;
        references.remarks.push_back(fmt::format(
            "The references of \"{}\" and \"{}\" contradict each other: one is biased. Stock's samplers made "
            "the references instead.",
            makers[0].choice.label, makers[1].choice.label));
    }
    if (references.all.size() > 1)
        if (std::optional<Doubt> doubt =
                Disagreement(references.all[0], references.all[1], areStocks, &references.areDoubtful))
            references.doubts.push_back(*doubt);
    for (const SamplerChoice &s : settings.samplers)
        references.ofSampler.push_back(s.label == references.all[0].sampler && references.all.size() > 1 ? 1 : 0);
    return references;
}

std::string UserCacheFolder() {
    // The XDG specification ignores relative paths.
    for (const auto &[variable, below] : {std::pair("XDG_CACHE_HOME", "pbrt_octree"), {"HOME", ".cache/pbrt_octree"}})
        if (const char *value = std::getenv(variable); value && fs::path(value).is_absolute())
            return (fs::path(value) / below).string();
    return {};
}

Reference ReadReference(const std::string &path, const LabScene &scene) {
    const ImageFile file = ReadImage(path);
    Reference reference = Described(path, file.metadata);
    reference.image = scene.built.film->PixelsIn(file, path);
    const ImageMetadata own = scene.Metadata(*scene.built.film, "", 0, 0);
    RequireEqual<std::string>(path, file.metadata, own, "lightlab.sceneHash");
    RequireEqual<int>(path, file.metadata, own, "pbrt.maxDepth");
    RequireEqual<int>(path, file.metadata, own, "lightlab.sampledLight");
    if (!IsFinite(reference.image)) throw UserError("{}: the reference has pixels that are not finite.", path);
    return reference;
}

}  // namespace ext::lab
