#include "ext/guiding/path_guide.h"

#include <nlohmann/json.hpp>

#include "ext/guiding/guided_directions.h"
#include "pbrt/core/effective_params_text.h"
#include "pbrt/integrators/registry.h"

namespace ext {
namespace {

/// Sample counts per pixel after which the guide is updated from the samples since the last update, if at least as many
/// follow. If one sample per pixel gives less than half of the paths to record, the counts are multiples of the number
/// that gives half.
constexpr int kUpdateAfter[] = {2, 4, 16};
/// Records at most one in this many of the image's paths per update, as recording costs time.
constexpr size_t kPathsPerRecorded = 32;
constexpr size_t kEnoughPaths = 16384;  ///< small images record up to twice as many paths, but at most this many
/// The first estimate of PathGuide::SavedShare has few records and may be far too low. Directional guiding is disabled
/// below this fraction of GuideParams::minSaved, unless no update follows.
constexpr double kMinFirstSaving = 0.16;
/// With several times kEnoughPaths, the saving is first estimated from one path in this many.
constexpr size_t kFirstStride = 4;
/// Selects one in `stride` paths, in pairs of the two halves.
bool IsUsed(size_t path, size_t stride) { return path / 2 % stride == 0; }
constexpr int kMaxVertices = 5;
constexpr Float kInspectedWeight = 0.5f;  ///< throughput at which PathGuide::Inspect shows the continuation probability

/// Tolerances for equal views. kSameDistance: distance of ray origins, relative to PathGuide::EnvironmentDistance (a
/// thousandth of the scene). kSameDirection: distance of unit directions.
constexpr Float kSameDistance = 1e-4f, kSameDirection = 0.02f;

constexpr uint32_t kVersion = 14;  ///< incremented whenever the output of PathGuide::SaveLearned changes

}  // namespace

bool PathGuide::Guides(const Bsdf &bsdf) {
    const BxdfFlags flags = bsdf.Flags();
    return IsNonSpecular(flags) && !(IsTransmissive(flags) && Has(flags, BxdfFlags::Glossy)) && bsdf.HasExactF();
}

void PathGuide::Prepare(PrepareContext &prepare, int maxDepth) {
    pixels_ = prepare.pixelBounds;
    samplesPerPixel_ = prepare.samplesPerPixel;
    vertices_ = std::clamp(maxDepth, 1, kMaxVertices);
    cells_.Clear();
    estimatesDirections_ = params_.directions;
    const Bounds3 &bounds = prepare.scene.Bounds();
    environmentDistance_ = bounds.IsEmpty() ? 1 : 10 * Length(bounds.high - bounds.low);
    perRadianceUnit_ = Float(std::clamp(1 / prepare.scene.Lights().Unit(), 0x1p-120, 0x1p120));
    static constexpr Vector2 kPlaces[View::kRays] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0.5f, 0.5f}};
    const Point2 low(prepare.pixelBounds.low);
    const Vector2 size = Point2(prepare.pixelBounds.high) - low;
    const SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    view_ = {};
    for (size_t i = 0; i < View::kRays; ++i) {
        const CameraSample sample{.pFilm = low + kPlaces[i] * size, .pLens = {0.5f, 0.5f}, .time = 0.5f};
        const std::optional<CameraRay> ray = prepare.camera.GenerateRay(sample, lambda);
        if (!ray) continue;
        view_.from[i] = ray->ray.o;
        view_.towards[i] = ray->ray.d;
    }
    BeginRecording(0, NextAfter(0));
    // Learned lights contain no guide if the render that saved them had none.
    if (!prepare.learned || prepare.learned->BytesLeft() == 0) return;
    StateReader &in = *prepare.learned;
    in.Require(in.Value<uint32_t>() == kVersion, "another version of the guide wrote it");
    if (!prepare.learnsOn) return LoadOfOther(in);
    const int first = in.Value<int>(), next = in.Value<int>();
    int learned = 0;
    while (learned < first && NextAfter(learned) != 0) learned = NextAfter(learned);
    // A guide loaded from another render does not learn further.
    in.Require(learned == first && (next == 0 || next == NextAfter(first)),
               "the guide learns after a wrong number of samples");
    LoadEstimates(in);
    in.Require(!roulette_.HasEstimates() || roulette_.Size() == Size(), "roulette was learned for another image");
    BeginRecording(first, next);
    MergeRecords(in);
    in.RequireEnd();
}

SampledSpectrum PathGuide::Li(const CameraPathSetup &setup, const CameraPathStart &start, SampledWavelengths &lambda,
                              Sampler &sampler) {
    GuidedDirections directions(*this, start.pixel, start.sampleIndex);
    if (setup.settings.tracksMedia)
        return CameraPath<MediaThroughput, GuidedDirections>(setup, start, lambda, sampler, directions).Follow();
    return CameraPath<SurfaceThroughput, GuidedDirections>(setup, start, lambda, sampler, directions).Follow();
}

void PathGuide::SaveLearned(StateWriter &out, bool withLearning) const {
    if (!withLearning) return out(kVersion, EffectiveParamsText(params_), view_, *this);
    out(kVersion, first_, next_, *this);
    records_.Save(out);
    roulette_.SaveRecords(out);
}

void PathGuide::LoadOfOther(StateReader &in) {
    GuideParams withDirections = params_;
    withDirections.directions = true;
    const std::string saved = in.Text(), here = EffectiveParamsText(params_);
    if (saved != here && saved != EffectiveParamsText(withDirections))
        throw UserError("{}: was learned by a guide with other parameters: {}; here they are {}.", in.What(), saved,
                        here);
    const auto view = in.Value<View>();
    LoadEstimates(in);
    in.RequireEnd();
    bool isSame = true;  // at any resolution
    for (size_t i = 0; i < View::kRays; ++i)
        isSame = isSame && Distance(view.from[i], view_.from[i]) <= kSameDistance * environmentDistance_ &&
                 Length(view.towards[i] - view_.towards[i]) <= kSameDirection;
    roulette_.UseFor(Size(), isSame);
    BeginRecording(0, 0);
}

void PathGuide::Inspect(const PathVertex &vertex, Point2i pixel, std::vector<InspectedValue> &values) const {
    const double none = std::numeric_limits<double>::quiet_NaN();
    const Point3 &p = vertex.point.p;
    const Float importance = PixelImportance(InImage(pixel));
    const Float continuation = roulette_.HasEstimates() ? PathRoulette::ContinuationProbability(
                                                              roulette_.At(p, PathRoulette::KindOf(vertex)).here,
                                                              kInspectedWeight * importance)
                                                        : 0;
    values.push_back({"continuationProbability", continuation > 0 ? double(continuation) : none});
    if (!params_.directions) return;
    Float probability = 0;
    if (Guides(vertex.bsdf) &&
        !cells_.At(p, Has(vertex.bsdf.Flags(), BxdfFlags::Glossy), Sqr(importance), &probability))
        probability = 0;
    const Float radiance = cells_.ShinesAt(p);
    values.push_back({"guidingProbability", double(probability)});
    values.push_back({"sourceRadiance", radiance > 0 ? std::log10(double(radiance)) : none});
}

size_t PathGuide::PathsToRecord() const {
    const size_t few = Pixels() * samplesPerPixel_ / kPathsPerRecorded;
    return std::min(params_.records / vertices_, std::max(few, std::min(2 * few, kEnoughPaths)));
}

int PathGuide::NextAfter(int first) const {
    const size_t pixels = std::max<size_t>(1, Pixels());
    const size_t unit = std::max<size_t>(1, (PathsToRecord() + 2 * pixels - 1) / (2 * pixels));
    for (const int k : kUpdateAfter)
        if (const size_t next = k * unit; next > size_t(first))
            return 2 * next <= size_t(samplesPerPixel_) ? int(next) : 0;
    return 0;
}

void PathGuide::BeginRecording(int first, int next) {
    first_ = first;
    next_ = next;
    paths_ = next_ > 0 ? RecordedPaths(pixels_, first_, next_, PathsToRecord()) : RecordedPaths();
    // The first samples record no directions, as the pixel importance is not estimated yet.
    records_.Begin(estimatesDirections_ && first_ > 0 ? paths_.Count() : 0, vertices_);
    roulette_.BeginRecords(params_.roulette ? paths_.Count() : 0, vertices_ + 1);
    recordBytes_ = std::max(recordBytes_, records_.Bytes() + roulette_.RecordBytes());
}

void PathGuide::Update(const Progress &progress) {
    if (progress.Cancelled()) return;
    const int now = next_;
    const auto start = std::chrono::steady_clock::now();
    if (params_.roulette) roulette_.Learn(Size(), [&](size_t path) { return paths_.PixelOf(path); });
    if (records_.IsOpen()) EstimateDirections(double(params_.minSaved) * (NextAfter(now) != 0 ? kMinFirstSaving : 1));
    BeginRecording(now, NextAfter(now));
    updateSeconds_ += SecondsSince(start);
}

void PathGuide::EstimateDirections(double minSaved) {
    const auto pays = [&] {
        if (savedShare_ >= minSaved) return true;
        cells_.Clear();
        estimatesDirections_ = false;
        return false;
    };
    const std::span<const GuideRecord> all = records_.Places();
    if (!cells_.Guide() && all.size() / vertices_ >= kFirstStride * kEnoughPaths) {
        std::vector<GuideRecord> some;
        for (size_t i = 0; i < all.size(); ++i)
            if (IsUsed(records_.PathOf(i), kFirstStride)) some.push_back(all[i]);
        cells_.Learn(some, params_.share);
        savedShare_ = SavedShare(kFirstStride);
        if (!pays()) return;
    }
    cells_.Learn(all, params_.share);
    savedShare_ = SavedShare(1);
    pays();
}

double PathGuide::SavedShare(size_t stride) const {
    if (!roulette_.HasEstimates()) return 1;
    double saved = 0;
    for (size_t i = 0; i < records_.Places().size(); ++i) {
        const GuideRecord &r = records_.Places()[i];
        const size_t path = records_.PathOf(i);
        if (!r.IsEmpty() && IsUsed(path, stride))
            saved += double(cells_.SavedAt(r.p, r.isGlossy, Sqr(r.beta * PixelImportance(paths_.PixelOf(path)))));
    }
    return double(stride) * saved / roulette_.RecordedCost();
}

void PathGuide::Report(nlohmann::ordered_json &json) const {
    json["rouletteCells"] = roulette_.Cells();
    json["cells"] = cells_.Cells();
    json["guidingCells"] = cells_.GuidingCells();
    json["sourceClusters"] = cells_.Clusters().count;
    json["savedShare"] = savedShare_;
    json["meanGuidingProbability"] = cells_.MeanProbability();
    json["bytes"] = cells_.Bytes() + roulette_.Bytes();
    json["recordBytes"] = recordBytes_;
    json["learningSeconds"] = updateSeconds_;
}

}  // namespace ext

void register_guide(pbrt::PluginRegistry &registry) {
    using namespace ext;
    registry.directionSamplings.Add<GuideParams>(
        "guide", "path guiding and learned Russian roulette, from records of the render; written octree+guide",
        [](GuideParams p, const ParamSet &, const DirectionRequest &request) -> std::unique_ptr<DirectionSampling> {
            if (!request.isGuided && !p.roulette) return nullptr;
            p.directions &= request.isGuided;
            return std::make_unique<PathGuide>(p);
        });
}
