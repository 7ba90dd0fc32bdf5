#pragma once
#include <array>
#include <vector>

#include "ext/guiding/guide_cells.h"
#include "ext/guiding/path_roulette.h"
#include "pbrt/bxdfs/bsdf.h"
#include "pbrt/core/params.h"
#include "pbrt/integrators/direction_sampling.h"
#include "pbrt/transport/vertex.h"

namespace ext {

struct GuideParams {
    bool roulette = true;
    bool directions = true;
    Float share = 0.7f;
    /// Minimum estimated saving, as a fraction of the path cost. Guiding costs about a tenth of the time; the estimate
    /// includes outliers and is far too high.
    Float minSaved = 0.5f;
    int records = 1 << 19;
    void Describe(auto &&v) {
        v("roulette", roulette, "learned Russian roulette; with octree also without guide");
        v("directions", directions, "directional guiding, where it pays");
        v.OnlyWith("directions", "true");
        v("share", share, Range<Float>{0, 0.95f}, "maximum probability of guided directions");
        v("leastsaved", minSaved, Range<Float>{0, 1000}, "guiding stops below this saving per path cost; 0: never");
        v.OnlyWith("", "");
        v("records", records, Range<int>{1000, 1 << 26},
          "maximum vertices recorded per update (32 bytes, with directions 104)");
    }
};

/// Path guiding and Russian roulette, learned during the render. Directions follow sources of radiance (GuideCells),
/// weighted by the MIS weight of the bounce, which excludes radiance that light sampling covers. Russian roulette uses
/// the same paths (PathRoulette).
class PathGuide final : public DirectionSampling {
  public:
    explicit PathGuide(const GuideParams &params) : params_(params), estimatesDirections_(params.directions) {}
    void Prepare(PrepareContext &prepare, int maxDepth) override;
    SampledSpectrum Li(const CameraPathSetup &setup, const CameraPathStart &start, SampledWavelengths &lambda,
                       Sampler &sampler) override;

    /// True if bounces at this BSDF are guided or recorded.
    static bool Guides(const Bsdf &bsdf);
    /// PathRoulette::PixelImportance, with pixels relative to the image corner; infinite before the first estimate.
    /// Multiplied by throughput (mean over wavelengths) and squared, it is the importance of GuideCells::At.
    Float PixelImportance(Point2i pixel) const {
        return roulette_.HasEstimates() ? roulette_.PixelImportance(pixel) : std::numeric_limits<Float>::infinity();
    }
    const GuideCells &Cells() const { return cells_; }

    /// Radiance is recorded times this, so that its squares fit in single precision.
    Float PerRadianceUnit() const { return perRadianceUnit_; }
    /// Source distance assigned to rays that leave the scene.
    Float EnvironmentDistance() const { return environmentDistance_; }
    /// False if directional guiding is off or disabled; bounces are then not recorded.
    bool EstimatesDirections() const { return estimatesDirections_; }
    /// Null: roulette by throughput alone.
    PathRoulette *Roulette() { return params_.roulette ? &roulette_ : nullptr; }
    void Inspect(const PathVertex &vertex, Point2i pixel, std::vector<InspectedValue> &values) const override;
    Point2i InImage(Point2i pixel) const { return pixel - pixels_.low; }  ///< pixel relative to the image corner
    std::optional<size_t> PathNumber(Point2i pixel, int sample) const { return paths_.NumberOf(pixel, sample); }
    /// Record slots for the bounces of a path; the path stores the range.
    PathObserver::PathPlaces BeginRecords(std::optional<size_t> path) const { return records_.PlacesOf(path); }
    void Record(PathObserver::PathPlaces &path, GuideRecord record) {
        record.isOfFirstHalf = path.end / vertices_ % 2 == 0;
        records_.Add(path, record);
    }

    int NextUpdate() const override { return next_; }
    void Update(const Progress &progress) override;
    void ExtractRecords(StateWriter &out) override {
        records_.Extract(out);
        roulette_.ExtractRecords(out);
    }
    void MergeRecords(StateReader &in) override {
        records_.Merge(in);
        roulette_.MergeRecords(in);
    }

    /// The estimates, without records.
    void Visit(auto &archive) { archive(estimatesDirections_, cells_, roulette_); }
    std::optional<std::string> Validate() const {
        return estimatesDirections_ || cells_.Cells() == 0 ? std::nullopt
                                                           : std::optional("it has directional guiding, which is off");
    }
    void SaveLearned(StateWriter &out, bool withLearning) const override;
    /// Cells, guided cells, saved share of the path cost, memory of estimates and (maximum) records, update time.
    void Report(nlohmann::ordered_json &json) const override;

  private:
    /// Rays through the image's corners and centre.
    struct View {
        static constexpr size_t kRays = 5;
        std::array<Point3, kRays> from{};
        std::array<Vector3, kRays> towards{};
    };
    void LoadOfOther(StateReader &in);
    void LoadEstimates(StateReader &in) {
        in(*this);
        if (!params_.directions) {  // of a render with them
            cells_.Clear();
            estimatesDirections_ = false;
        }
        cells_.LeavesChanged();
    }

    Vector2i Size() const { return pixels_.IsEmpty() ? Vector2i(0) : pixels_.high - pixels_.low; }
    size_t Pixels() const { return size_t(Size().x) * Size().y; }
    size_t PathsToRecord() const;    ///< maximum paths recorded between two updates
    int NextAfter(int first) const;  ///< samples per pixel at the next update after `first`; 0: none
    /// Allocates records for samples [first, next); none if `next` is 0.
    void BeginRecording(int first, int next);
    /// Disables directional guiding if it saves less than this fraction of the path cost.
    void EstimateDirections(double minSaved);
    /// Fraction of the path cost that guiding saves, from the records of one path in `stride`.
    double SavedShare(size_t stride) const;

    GuideParams params_;
    GuideCells cells_;
    bool estimatesDirections_;
    Bounds2i pixels_{};
    View view_;
    int samplesPerPixel_ = 1, next_ = 0, first_ = 0;
    size_t vertices_ = 1;
    Float environmentDistance_ = 0, perRadianceUnit_ = 1;
    RecordedPaths paths_;
    PathRecordStore<GuideRecord> records_;
    PathRoulette roulette_;
    size_t recordBytes_ = 0;  ///< maximum so far
    double savedShare_ = 0;   ///< at the last update
    double updateSeconds_ = 0;
};

}  // namespace ext
