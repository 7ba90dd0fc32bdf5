#pragma once
#include <array>
#include <memory>
#include <vector>

#include "ext/guiding/guide_cells.h"
#include "ext/guiding/path_roulette.h"
#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/core/params.h"
#include "pbrt/integrators/direction_sampling.h"
#include "pbrt/transport/vertex.h"

namespace ext {

/// Parameters of guided paths.
struct GuideParams {
    bool roulette = true;
    bool directions = true;
    Float share = 0.7f;
    /// Guiding costs about a tenth of the time, and the estimate of its saving, which includes outliers, is far too
    /// high.
    Float minSaved = 0.5f;
    int records = 1 << 19;
    template <class V>
    void Describe(V &&v) {
        v("roulette", roulette,
          "learned Russian roulette: continuation probabilities from the radiance and the cost of earlier paths");
        v("directions", directions,
          "path guiding: directions towards sources of radiance of earlier paths, in scenes where that pays");
        v("share", share, Range<Float>{0, 0.95f},
          "largest guiding probability: directions from the guide, not from the BSDF");
        v("leastsaved", minSaved, Range<Float>{0, 1000},
          "directional guiding is disabled when its estimated saving is below this part of the path cost; 0: never");
        v("records", records, Range<int>{1000, 1 << 26},
          "largest number of vertices recorded between two updates (32 bytes each, with directions 104)");
    }
};

/// Learns, while a render goes on, where the light that only bounces find comes from (GuideCells): light times the
/// bounce's MIS weight, so that what light sampling finds better does not count. It learns together with the light
/// sampler, if that learns (LightLearner).
/// Roulette by what paths found from a place on is learned from the same paths (PathRoulette).
class PathGuide final : public DirectionSampling {
  public:
    explicit PathGuide(const GuideParams &params) : params_(params), estimatesDirections_(params.directions) {}
    void Prepare(PrepareContext &prepare, int maxDepth) override;
    SampledSpectrum Li(const CameraPathSetup &setup, const PathStart &start, SampledWavelengths &lambda,
                       Sampler &sampler) override;

    /// True if bounces at such a BSDF are guided or learned from.
    static bool Guides(const Bsdf &bsdf);
    /// PathRoulette::PixelImportance of a pixel, relative to the picture's corner; infinite before it is known. Times a
    /// path's weight (mean over wavelengths) and squared, it is what GuideCells::At asks for.
    Float PixelImportance(Point2i pixel) const {
        return roulette_.HasEstimates() ? roulette_.PixelImportance(pixel) : std::numeric_limits<Float>::infinity();
    }
    const GuideCells &Cells() const { return cells_; }

    /// How far away what rays find that leave the scene counts as.
    Float EnvironmentDistance() const { return environmentDistance_; }
    /// False if bounces are never guided and leave no records: it was not asked for, or does not pay in this scene.
    bool EstimatesDirections() const { return estimatesDirections_; }
    /// Null: paths end by their weight alone.
    PathRoulette *Roulette() { return params_.roulette ? &roulette_ : nullptr; }
    /// What is known at a vertex, for pictures. `pixel`: whose path it is.
    void Inspect(const PathVertex &vertex, Point2i pixel, std::vector<InspectedValue> &values) const override;
    /// A pixel, relative to the picture's corner.
    Point2i InPicture(Point2i pixel) const { return pixel - pixels_.low; }
    /// The number of a path that is recorded.
    std::optional<size_t> PathNumber(Point2i pixel, int sample) const;
    /// The places for records of a path's bounces. The path keeps the range.
    PathObserver::PathPlaces BeginRecords(std::optional<size_t> path) const {
        return path && !places_.empty() ? PathObserver::PathPlaces{*path * vertices_, (*path + 1) * vertices_}
                                        : PathObserver::PathPlaces{};
    }
    void Record(PathObserver::PathPlaces &path, const GuideRecord &record) {
        if (path.next >= path.end) return;
        GuideRecord &place = places_[path.next++];
        place = record;
        place.isOfFirstHalf = path.end / vertices_ % 2 == 0;
    }

    int NextUpdate() const override { return next_; }
    void Update(const Progress &progress) override;
    void ExtractRecords(StateWriter &out) override;
    void MergeRecords(StateReader &in) override { AddRecords(in); }

    /// What was learned and found, for a checkpoint, without what the light sampler learned.
    void Save(StateWriter &out) const override;
    /// What was learned, for other renders. They may have another camera or another resolution, and learn nothing more.
    void SaveForOthers(StateWriter &out) const override;
    /// Cells, how many of them guide, the part of the paths' cost that this saves, memory of what is known and, at
    /// most, of records, and the time of learning.
    void Report(nlohmann::ordered_json &json) const override;

  private:
    /// What the picture shows: rays through its corners and its middle.
    struct View {
        static constexpr size_t kRays = 5;
        std::array<Point3, kRays> from{};
        std::array<Vector3, kRays> towards{};
    };
    static View ViewOf(const PrepareContext &prepare);
    /// True if both show the same, but for what another resolution changes.
    bool IsSame(const View &a, const View &b) const;
    void LoadOfOther(StateReader &in);
    void LoadCells(StateReader &in);

    Vector2i Size() const { return pixels_.IsEmpty() ? Vector2i(0) : pixels_.high - pixels_.low; }
    size_t Pixels() const { return static_cast<size_t>(Size().x) * static_cast<size_t>(Size().y); }
    /// At most so many are recorded for a learning.
    size_t PathsToRecord() const;
    /// Samples per pixel after which to learn, if it was learned or begun after `first`; 0: not again.
    int NextAfter(int first) const;
    /// Makes places for what samples [first, next) find; for none if `next` is 0.
    void BeginRecording(int first, int next);
    /// The pixel of a path's number, relative to the picture's corner.
    Point2i PixelOf(size_t path) const;
    /// Gives directions up if they save less than this part of what paths cost.
    void EstimateDirections(double minSaved);
    /// What guiding saves, of all that paths cost, as the records of one path in `asked` tell.
    double SavedShare(size_t asked) const;
    void TakeRecords(StateWriter &out) const;
    void AddRecords(StateReader &in);

    GuideParams params_;
    GuideCells cells_;
    bool estimatesDirections_;
    Bounds2i pixels_{};
    View view_;
    int samplesPerPixel_ = 1, next_ = 0, first_ = 0, stride_ = 1;
    size_t vertices_ = 1, placesPerRow_ = 0;
    Float environmentDistance_ = 0;  ///< how far away what is beyond the scene counts as
    std::vector<GuideRecord> places_;
    PathRoulette roulette_;
    size_t recordBytes_ = 0;  ///< the most so far
    double savedShare_ = 0;   ///< when directions were learned last
    double updateSeconds_ = 0;
};

}  // namespace ext
