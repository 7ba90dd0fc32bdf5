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

/// Path guiding, learned during the render: directions towards sources of radiance (GuideCells), recorded times the
/// MIS weight of the bounce, so that radiance that light sampling finds better does not count; and Russian roulette
/// from the same paths (PathRoulette).
class PathGuide final : public DirectionSampling {
  public:
    explicit PathGuide(const GuideParams &params) : params_(params), estimatesDirections_(params.directions) {}
    void Prepare(PrepareContext &prepare, int maxDepth) override;
    SampledSpectrum Li(const CameraPathSetup &setup, const PathStart &start, SampledWavelengths &lambda,
                       Sampler &sampler) override;

    /// True if bounces at such a BSDF are guided or learned from.
    static bool Guides(const Bsdf &bsdf);
    /// PathRoulette::PixelImportance of a pixel, relative to the picture's corner; infinite before the first estimate.
    /// Times throughput (mean over wavelengths), squared, it is the importance of GuideCells::At.
    Float PixelImportance(Point2i pixel) const {
        return roulette_.HasEstimates() ? roulette_.PixelImportance(pixel) : std::numeric_limits<Float>::infinity();
    }
    const GuideCells &Cells() const { return cells_; }

    /// Distance of sources that rays find which leave the scene.
    Float EnvironmentDistance() const { return environmentDistance_; }
    /// False if directional guiding is off or disabled: then bounces are not recorded.
    bool EstimatesDirections() const { return estimatesDirections_; }
    /// Null: roulette by throughput alone.
    PathRoulette *Roulette() { return params_.roulette ? &roulette_ : nullptr; }
    /// Estimates at a vertex of a path of a pixel, for views.
    void Inspect(const PathVertex &vertex, Point2i pixel, std::vector<InspectedValue> &values) const override;
    /// A pixel, relative to the picture's corner.
    Point2i InPicture(Point2i pixel) const { return pixel - pixels_.low; }
    /// The number of a path that is recorded; empty: it is not.
    std::optional<size_t> PathNumber(Point2i pixel, int sample) const { return paths_.NumberOf(pixel, sample); }
    /// The places for records of a path's bounces. The path keeps the range.
    PathObserver::PathPlaces BeginRecords(std::optional<size_t> path) const { return records_.PlacesOf(path); }
    void Record(PathObserver::PathPlaces &path, GuideRecord record) {
        record.isOfFirstHalf = path.end / vertices_ % 2 == 0;
        records_.Add(path, record);
    }

    int NextUpdate() const override { return next_; }
    void Update(const Progress &progress) override;
    void ExtractRecords(StateWriter &out) override;
    void MergeRecords(StateReader &in) override;

    /// Estimates and records, for a checkpoint, without those of the light sampler.
    void Save(StateWriter &out) const override;
    /// Estimates, for other renders. They may have another camera or another resolution, and learn nothing more.
    void SaveForOthers(StateWriter &out) const override;
    /// Cells, how many of them guide, the saved part of the path cost, memory of estimates and, at most, of records,
    /// and the time of updates.
    void Report(nlohmann::ordered_json &json) const override;

  private:
    /// Rays through the corners and the middle of the picture.
    struct View {
        static constexpr size_t kRays = 5;
        std::array<Point3, kRays> from{};
        std::array<Vector3, kRays> towards{};
    };
    static View ViewOf(const PrepareContext &prepare);
    /// True if both are the same view, at any resolution.
    bool IsSame(const View &a, const View &b) const;
    void LoadOfOther(StateReader &in);
    void LoadCells(StateReader &in);

    Vector2i Size() const { return pixels_.IsEmpty() ? Vector2i(0) : pixels_.high - pixels_.low; }
    size_t Pixels() const { return static_cast<size_t>(Size().x) * static_cast<size_t>(Size().y); }
    /// At most so many are recorded between two updates.
    size_t PathsToRecord() const;
    /// Samples per pixel of the next update after `first`; 0: none.
    int NextAfter(int first) const;
    /// Makes places for records of samples [first, next); none if `next` is 0.
    void BeginRecording(int first, int next);
    /// Disables directional guiding if it saves less than this part of the path cost.
    void EstimateDirections(double minSaved);
    /// The part of the path cost that guiding saves, from the records of one path in `stride`.
    double SavedShare(size_t stride) const;

    GuideParams params_;
    GuideCells cells_;
    bool estimatesDirections_;
    Bounds2i pixels_{};
    View view_;
    int samplesPerPixel_ = 1, next_ = 0, first_ = 0;
    size_t vertices_ = 1;
    Float environmentDistance_ = 0;
    RecordedPaths paths_;
    PathRecordStore<GuideRecord> records_;
    PathRoulette roulette_;
    size_t recordBytes_ = 0;  ///< the most so far
    double savedShare_ = 0;   ///< of the last update
    double updateSeconds_ = 0;
};

}  // namespace ext
