#include "ext/guiding/path_guide.h"

#include <chrono>
#include <nlohmann/json.hpp>

#include "pbrt/core/effective_params_text.h"
#include "pbrt/core/state_io.h"
#include "pbrt/math/bounds.h"
#include "pbrt/scene/scene.h"

namespace ext {

namespace {

/// The guide learns after these numbers of samples per pixel, from the samples since it learned last, if at least as
/// many are still to come. Where one sample per pixel makes less than half of the paths to be recorded, the numbers are
/// multiples of what makes half of them.
constexpr int kUpdateAfter[] = {2, 4, 16};
/// One in so many of the picture's paths is recorded for a learning, at most, as records cost time.
constexpr size_t kPathsPerRecorded = 32;
/// Of small pictures up to twice as many paths are recorded, but no more than this.
constexpr size_t kEnoughPaths = 16384;
/// The first estimate of PathGuide::SavedShare has few records and may be far too low: directional guiding is disabled
/// below this part of GuideParams::minSaved, unless no update follows.
constexpr double kMinFirstSaving = 0.16;
/// Where the records are of several times kEnoughPaths, one path in so many is asked first whether directions pay, as
/// learning from all of them takes longer.
constexpr size_t kAsked = 4;
/// One of `asked` paths, in pairs of the two halves.
bool IsAsked(size_t path, size_t asked) { return path / 2 % asked == 0; }
/// Only so many vertices of a path are recorded.
constexpr int kMaxVertices = 5;
/// Each row of pixels is shifted by this much against the row before, so that the recorded pixels do not form columns.
constexpr int kRowShift = 7;

/// The throughput at which PathGuide::Inspect shows the continuation probability.
constexpr Float kInspectedWeight = 0.5f;

/// Two pictures show the same if rays at the same places in them begin no further apart than this part of
/// PathGuide::EnvironmentDistance, a thousandth of the scene, and their directions (unit) are no further apart than
/// this.
constexpr Float kSameDistance = 1e-4f, kSameDirection = 0.02f;

/// Changes with everything that PathGuide::Save and SaveForOthers write.
constexpr uint32_t kVersion = 10;

}  // namespace

bool PathGuide::Guides(const Bsdf &bsdf) {
    const BxdfFlags flags = bsdf.Flags();
    return IsNonSpecular(flags) && !(IsTransmissive(flags) && Has(flags, BxdfFlags::Glossy)) && bsdf.HasExactF();
}

void PathGuide::Prepare(PrepareContext &prepare, int maxDepth) {
    pixels_ = prepare.pixelBounds;
    samplesPerPixel_ = prepare.samplesPerPixel;
    vertices_ = static_cast<size_t>(std::clamp(maxDepth, 1, kMaxVertices));
    cells_.Clear();
    estimatesDirections_ = params_.directions;
    const Bounds3 &bounds = prepare.scene.Bounds();
    environmentDistance_ = bounds.IsEmpty() ? 1 : 10 * Length(bounds.high - bounds.low);
    view_ = ViewOf(prepare);
    BeginRecording(0, NextAfter(0));
    // A file of learned lights has nothing for the guide if the render that made it had none.
    if (!prepare.learned || prepare.learned->BytesLeft() == 0) return;
    StateReader &in = *prepare.learned;
    in.Require(in.Value<uint32_t>() == kVersion, "another version of the guide wrote it");
    if (!prepare.learnsOn) return LoadOfOther(in);
    const int first = in.Value<int>(), next = in.Value<int>();
    int learned = 0;
    while (learned < first && NextAfter(learned) != 0) learned = NextAfter(learned);
    // A guide that was loaded from another render learns no more.
    in.Require(learned == first && (next == 0 || next == NextAfter(first)),
               "the guide learns after a wrong number of samples");
    LoadCells(in);
    in.Require(!roulette_.HasEstimates() || roulette_.Size() == Size(), "roulette was learned for another picture");
    BeginRecording(first, next);
    AddRecords(in);
    in.RequireEnd();
}

void PathGuide::Save(StateWriter &out) const {
    out.Value(kVersion);
    out.Value(first_);
    out.Value(next_);
    out.Value(estimatesDirections_);
    cells_.Save(out);
    roulette_.Save(out);
    TakeRecords(out);
}

PathGuide::View PathGuide::ViewOf(const PrepareContext &prepare) {
    static constexpr Vector2 kPlaces[View::kRays] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}, {0.5f, 0.5f}};
    const Point2 low(prepare.pixelBounds.low);
    const Vector2 size = Point2(prepare.pixelBounds.high) - low;
    const SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    View view;
    for (size_t i = 0; i < View::kRays; ++i) {
        const CameraSample sample{.pFilm = low + kPlaces[i] * size, .pLens = {0.5f, 0.5f}, .time = 0.5f};
        const std::optional<CameraRay> ray = prepare.camera.GenerateRay(sample, lambda);
        if (!ray) continue;
        view.from[i] = ray->ray.o;
        view.towards[i] = ray->ray.d;
    }
    return view;
}

bool PathGuide::IsSame(const View &a, const View &b) const {
    for (size_t i = 0; i < View::kRays; ++i)
        if (!(Distance(a.from[i], b.from[i]) <= kSameDistance * environmentDistance_ &&
              Length(a.towards[i] - b.towards[i]) <= kSameDirection))
            return false;
    return true;
}

void PathGuide::SaveForOthers(StateWriter &out) const {
    out.Value(kVersion);
    out.Text(EffectiveParamsText(params_));
    out.Value(view_);
    out.Value(estimatesDirections_);
    cells_.Save(out);
    roulette_.Save(out);
}

void PathGuide::LoadCells(StateReader &in) {
    estimatesDirections_ = in.Value<bool>();
    in.Require(params_.directions || !estimatesDirections_, "it has directions, which are off");
    cells_.Load(in);
    roulette_.Load(in);
}

void PathGuide::LoadOfOther(StateReader &in) {
    const std::string saved = in.Text(), here = EffectiveParamsText(params_);
    if (saved != here)
        throw UserError(fmt::format("{}: was learned by a guide with other parameters: {}; here they are {}.",
                                    in.What(), saved, here));
    const auto view = in.Value<View>();
    LoadCells(in);
    in.RequireEnd();
    roulette_.UseFor(Size(), IsSame(view, view_));
    BeginRecording(0, 0);
}

void PathGuide::Inspect(const PathVertex &vertex, Point2i pixel, std::vector<InspectedValue> &values) const {
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    const Point3 &p = vertex.point.p;
    const Float worth = PixelImportance(InPicture(pixel));
    const Float survival = roulette_.HasEstimates()
                               ? PathRoulette::ContinuationProbability(
                                     roulette_.At(p, PathRoulette::KindOf(vertex)).here, kInspectedWeight * worth)
                               : 0;
    values.push_back({"survival", survival > 0 ? static_cast<double>(survival) : unknown});
    if (!params_.directions) return;
    Float share = 0;
    if (Guides(vertex.bsdf) && !cells_.At(p, Has(vertex.bsdf.Flags(), BxdfFlags::Glossy), Sqr(worth), &share))
        share = 0;
    const Float radiance = cells_.ShinesAt(p);
    values.push_back({"share", static_cast<double>(share)});
    values.push_back({"shines", radiance > 0 ? std::log10(static_cast<double>(radiance)) : unknown});
}

size_t PathGuide::PathsToRecord() const {
    const size_t few = Pixels() * static_cast<size_t>(samplesPerPixel_) / kPathsPerRecorded;
    return std::min(static_cast<size_t>(params_.records) / vertices_, std::max(few, std::min(2 * few, kEnoughPaths)));
}

int PathGuide::NextAfter(int first) const {
    const size_t pixels = std::max<size_t>(1, Pixels());
    const size_t unit = std::max<size_t>(1, (PathsToRecord() + 2 * pixels - 1) / (2 * pixels));
    for (const int k : kUpdateAfter)
        if (const size_t next = static_cast<size_t>(k) * unit; next > static_cast<size_t>(first))
            return 2 * next <= static_cast<size_t>(samplesPerPixel_) ? static_cast<int>(next) : 0;
    return 0;
}

void PathGuide::BeginRecording(int first, int next) {
    first_ = first;
    next_ = next;
    if (next_ == 0) {
        places_ = {};
        roulette_.BeginRecords(0, 0);
        return;
    }
    const Vector2i size = Size();
    const size_t most = PathsToRecord();
    for (stride_ = 1;; ++stride_) {
        placesPerRow_ = static_cast<size_t>((size.x + stride_ - 1) / stride_);
        const size_t paths = placesPerRow_ * static_cast<size_t>(size.y) * static_cast<size_t>(next_ - first_);
        if (paths > most && stride_ < size.x) continue;
        // Not yet of the first samples: what a path is worth is not known then.
        places_.assign(estimatesDirections_ && first_ > 0 ? paths * vertices_ : 0, {});
        roulette_.BeginRecords(params_.roulette ? paths : 0, vertices_ + 1);
        recordBytes_ = std::max(recordBytes_, places_.size() * sizeof(GuideRecord) + roulette_.RecordBytes());
        return;
    }
}

Point2i PathGuide::PixelOf(size_t path) const {
    const size_t ofPixel = path / static_cast<size_t>(next_ - first_);
    const int y = static_cast<int>(ofPixel / placesPerRow_);
    // x + kRowShift y is a multiple of the stride.
    const int shift = (stride_ - kRowShift * y % stride_) % stride_;
    return {static_cast<int>(ofPixel % placesPerRow_) * stride_ + shift, y};
}

std::optional<size_t> PathGuide::PathNumber(Point2i pixel, int sample) const {
    const Vector2i at = pixel - pixels_.low;
    if (next_ == 0 || sample < first_ || sample >= next_ || (at.x + kRowShift * at.y) % stride_ != 0) return {};
    const size_t ofPixel = static_cast<size_t>(at.y) * placesPerRow_ + static_cast<size_t>(at.x / stride_);
    return ofPixel * static_cast<size_t>(next_ - first_) + static_cast<size_t>(sample - first_);
}

void PathGuide::Update(const Progress &progress) {
    if (progress.Cancelled()) return;
    const int now = next_;
    const auto begin = std::chrono::steady_clock::now();
    if (params_.roulette) roulette_.Learn(Size(), [&](size_t path) { return PixelOf(path); });
    if (!places_.empty())
        EstimateDirections(static_cast<double>(params_.minSaved) * (NextAfter(now) != 0 ? kMinFirstSaving : 1));
    BeginRecording(now, NextAfter(now));
    updateSeconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void PathGuide::EstimateDirections(double minSaved) {
    const auto pays = [&] {
        if (savedShare_ >= minSaved) return true;
        cells_.Clear();
        estimatesDirections_ = false;
        return false;
    };
    if (!cells_.Guide() && places_.size() / vertices_ >= kAsked * kEnoughPaths) {
        std::vector<GuideRecord> some;
        for (size_t i = 0; i < places_.size(); ++i)
            if (IsAsked(i / vertices_, kAsked)) some.push_back(places_[i]);
        cells_.Learn(some, params_.share);
        savedShare_ = SavedShare(kAsked);
        if (!pays()) return;
    }
    cells_.Learn(places_, params_.share);
    savedShare_ = SavedShare(1);
    pays();
}

double PathGuide::SavedShare(size_t asked) const {
    if (!roulette_.HasEstimates()) return 1;
    double saved = 0;
    for (size_t i = 0; i < places_.size(); ++i) {
        const GuideRecord &r = places_[i];
        if (r.pdf > 0 && IsAsked(i / vertices_, asked))
            saved += static_cast<double>(
                cells_.SavedAt(r.p, r.isGlossy, Sqr(r.beta * PixelImportance(PixelOf(i / vertices_)))));
    }
    return static_cast<double>(asked) * saved / roulette_.RecordedCost();
}

void PathGuide::TakeRecords(StateWriter &out) const {
    uint64_t filled = 0;
    for (const GuideRecord &place : places_) filled += place.pdf > 0;
    out.Value(uint64_t{places_.size()});
    out.Value(filled);
    for (size_t i = 0; i < places_.size(); ++i) {
        if (!(places_[i].pdf > 0)) continue;
        out.Value(uint64_t{i});
        out.Value(places_[i]);
    }
    roulette_.TakeRecords(out);
}

void PathGuide::AddRecords(StateReader &in) {
    in.Require(in.Value<uint64_t>() == places_.size(), "it has other records than the render makes");
    for (auto filled = in.Value<uint64_t>(); filled > 0; --filled) {
        const auto i = in.Value<uint64_t>();
        in.Require(i < places_.size(), "a record has no place");
        places_[i] = GuideRecord::Read(in);
    }
    roulette_.AddRecords(in);
}

void PathGuide::ExtractRecords(StateWriter &out) {
    TakeRecords(out);
    std::fill(places_.begin(), places_.end(), GuideRecord{});
    roulette_.ClearRecords();
}

void PathGuide::Report(nlohmann::ordered_json &json) const {
    json["rouletteCells"] = roulette_.Cells();
    json["cells"] = cells_.Cells();
    json["guidingCells"] = cells_.GuidingCells();
    json["targets"] = cells_.Clusters().count;
    json["partSaved"] = savedShare_;
    json["meanShare"] = cells_.MeanShare();
    json["bytes"] = cells_.Bytes() + roulette_.Bytes();
    json["recordBytes"] = recordBytes_;
    json["learningSeconds"] = updateSeconds_;
}

}  // namespace ext
