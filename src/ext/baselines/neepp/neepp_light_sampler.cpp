#include "ext/baselines/neepp/neepp_light_sampler.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "pbrt/core/effective_params_text.h"
#include "pbrt/core/log.h"
#include "pbrt/integrators/registry.h"
#include "pbrt/math/low_discrepancy.h"

namespace ext {
namespace {
constexpr uint64_t kStream = 0x6e65657070ull;  ///< decorrelates the segments from other uses of the seed
constexpr int kEnvironmentSamples = 4096;

/// Calls visit(point, weight) for points uniform over a primitive's area, hardly missing a voxel. Weights sum to 1.
void ForPointsOn(const Shape &shape, uint32_t primitive, const VoxelGrid &grid, const auto &visit) {
    Bounds3 box = shape.PrimitiveBounds(primitive);
    if (grid.Index(box.low) == grid.Index(box.high)) {
        visit(box.Center(), Float(1));
        return;
    }
    Float span[3];
    for (int i = 0; i < 3; ++i) {
        Float size = grid.VoxelSize()[i];
        span[i] = size > 0 ? std::ceil((box.high[i] - box.low[i]) / size) + 1 : 1;
    }
    std::sort(span, span + 3);
    int n = int(std::clamp(8 * span[1] * span[2], Float(32), Float(4096)));
    for (int i = 0; i < n; ++i) {
        auto k = uint64_t(i);
        std::optional<ShapeSample> s = shape.SampleArea(primitive, {RadicalInverse(2, k), RadicalInverse(3, k)});
        visit(s ? s->p : box.Center(), 1 / Float(n));
    }
}
}  // namespace

uint32_t LightTargets::EnvironmentCellOf(const Vector3 &w) {
    const Point2i cell =
        glm::clamp(Point2i(EqualAreaSphereToSquare(w) * Float(kEnvironmentSide)), 0, kEnvironmentSide - 1);
    return uint32_t(cell.x + kEnvironmentSide * cell.y);
}

Vector3 LightTargets::DirectionIn(uint32_t cell, const Point2 &u) {
    Point2 corner(cell % kEnvironmentSide, cell / kEnvironmentSide);
    return EqualAreaSquareToSphere((corner + u) / Float(kEnvironmentSide));
}

/// Takes the lights in order, and FinishGroup after the last one of each group.
class LightTargets::Builder {
  public:
    Builder(const Scene &scene, const VoxelGrid &grid)
        : lights_(scene.Lights()), grid_(grid), bounds_(scene.Bounds().IsEmpty() ? Bounds3(Point3(0)) : scene.Bounds()),
          ofVoxel_(grid.Size(), kNone), ofEnvironmentCell_(kEnvironmentSide * kEnvironmentSide, kNone) {}

    /// `share`: of the light in its group.
    void Add(LightId id, double share) {
        const LightCandidate candidate = lights_.Candidate(id);
        if (!(candidate.power > 0)) return;
        const LightComponent light = lights_[id];
        if (light.Kind() == LightKind::DeltaDirection) {
            const LightSampleContext center{.p = bounds_.Center()};
            std::optional<LightLiSample> s =
                light.SampleLi(center, {0.5f, 0.5f}, SampledWavelengths::WholeRange(), true);
            if (s) weights_[AddTarget({Kind::Direction, 0, s->wi})] += share;
        } else if (light.Kind() == LightKind::Infinite) {
            for (uint64_t k = 0; k < kEnvironmentSamples; ++k) {
                // From points all over the scene, as the directions that a portal light samples depend on the point.
                LightSampleContext from;
                from.p = bounds_.low + bounds_.Diagonal() *
                                           Vector3(RadicalInverse(5, k), RadicalInverse(7, k), RadicalInverse(11, k));
                Point2 u(RadicalInverse(2, k), RadicalInverse(3, k));
                std::optional<LightLiSample> s = light.SampleLi(from, u, SampledWavelengths::WholeRange(), true);
                if (s && s->L && s->pdf > 0)
                    weights_[SharedTarget(Kind::EnvironmentCell, EnvironmentCellOf(s->wi))] += 1;
            }
        } else if (const ShapePrimitive at = light.Surface(); at.shape) {
            ForPointsOn(*at.shape, at.primitive, grid_, [&](const Point3 &p, Float weight) {
                weights_[SharedTarget(Kind::Voxel, grid_.Index(p))] += share * double(weight);
            });
        } else if (candidate.bounds) {
            weights_[SharedTarget(Kind::Voxel, grid_.Index(candidate.bounds->Centroid()))] += share;
        }
    }
    void FinishGroup() {
        double sum = 0;
        for (const auto &[target, weight] : weights_) sum += weight;
        for (const auto &[target, weight] : weights_)
            if (weight > 0) made_.shares_.push_back({target, Float(weight / sum)});
        made_.first_.push_back(uint32_t(made_.shares_.size()));
        weights_.clear();
    }
    LightTargets Take() { return std::move(made_); }

  private:
    static constexpr uint32_t kNone = 0xffffffffu;

    uint32_t AddTarget(const Target &target) {
        made_.targets_.push_back(target);
        return uint32_t(made_.targets_.size() - 1);
    }
    uint32_t SharedTarget(Kind kind, uint32_t index) {
        uint32_t &target = (kind == Kind::Voxel ? ofVoxel_ : ofEnvironmentCell_)[index];
        return target != kNone ? target : target = AddTarget({kind, index, {}});
    }

    const LightTable &lights_;
    const VoxelGrid &grid_;
    const Bounds3 bounds_;
    std::vector<uint32_t> ofVoxel_, ofEnvironmentCell_;  ///< targets
    std::map<uint32_t, double> weights_;                 ///< of the group's targets
    LightTargets made_;
};

LightTargets LightTargets::Of(const Scene &scene, const VoxelGrid &grid, const LightGroups &groups) {
    Builder builder(scene, grid);
    for (uint32_t g = 0; g < groups.Size(); ++g) {
        for (uint32_t i = groups.FirstOf(g), end = i + groups.CountOf(g); i < end; ++i)
            builder.Add(LightId(i), double(groups.ShareOf(LightId(i))));
        builder.FinishGroup();
    }
    return builder.Take();
}

size_t LightTargets::Bytes() const {
    return targets_.capacity() * sizeof(Target) + shares_.capacity() * sizeof(Share) +
           first_.capacity() * sizeof(uint32_t);
}

NeeppLightSampler::NeeppLightSampler(const LightTable &lights, const NeeppParams &params)
    : VoxelLightSampler(params.meshlights ? lights.ByLight() : lights.ByComponent()), params_(params) {}

void NeeppLightSampler::Prepare(PrepareContext &context) {
    if (groups_.Size() <= 1) return;
    const auto start = std::chrono::steady_clock::now();
    scene_ = &context.scene;
    PrepareVoxels(context, params_.voxels);
    targets_ = LightTargets::Of(context.scene, grid_, groups_);
    rows_.Reset(grid_.Size(), targets_.Size());
    auto work = double(grid_.BorderSize()) * double(targets_.Size()) * params_.samples;
    if (work > 3e8)
        LogWarning(
            "neepp: visibility to {} voxels and directions with lights takes about {:.1e} rays, {} for "
            "every voxel that a path enters for the first time.",
            targets_.Size(), work, targets_.Size() * params_.samples);
    prepareSeconds_ = SecondsSince(start);
}

void NeeppLightSampler::TestSegments(uint32_t voxel, std::span<uint8_t> row) const {
    // Scene::Occluded would count these as shadow rays of the render.
    const Accel &accel = scene_->Acceleration();
    for (uint32_t t = 0; t < row.size(); ++t) {
        const LightTargets::Target &target = targets_[t];
        Rng rng(Hash(kStream, seed_, voxel, t));
        int freeSegments = 0;
        for (int i = 0; i < params_.samples; ++i) {
            Ray ray;
            ray.o = grid_.PointIn(voxel, {rng.Uniform(), rng.Uniform(), rng.Uniform()});
            switch (target.kind) {
                case LightTargets::Kind::Voxel:
                    ray.d = grid_.PointIn(target.index, {rng.Uniform(), rng.Uniform(), rng.Uniform()}) - ray.o;
                    ray.tMax = 1;
                    break;
                case LightTargets::Kind::Direction: ray.d = target.direction; break;
                case LightTargets::Kind::EnvironmentCell:
                    ray.d = LightTargets::DirectionIn(target.index, rng.Uniform2());
                    break;
            }
            freeSegments += ray.d == Vector3(0) || !accel.Occluded(ray);
        }
        row[t] = uint8_t(freeSegments);
    }
}

Float NeeppLightSampler::GroupVisibility(std::span<const uint8_t> row, uint32_t group) const {
    Float sum = 0;
    for (const LightTargets::Share &s : targets_.SharesOf(group)) sum += s.weight * Float(row[s.target]);
    return std::min(Float(1), sum / Float(params_.samples));
}

std::string NeeppLightSampler::DescribeStructure() const {
    if (!IsPrepared()) return {};
    size_t voxels = 0, directions = 0;
    for (size_t i = 0; i < targets_.Size(); ++i)
        ++(targets_[i].kind == LightTargets::Kind::Voxel ? voxels : directions);
    return fmt::format(
        "{}lights in {} voxels and {} directions out of the scene, {} segments to each\n"
        "{} of {} voxels filled, {} KB, {:.3f} s of thread time to fill them\n",
        grid_.Describe(), voxels, directions, params_.samples, rows_.Filled(), rows_.Size(),
        (rows_.Bytes() + targets_.Bytes()) / 1000, rows_.FillThreadSeconds());
}

std::vector<double> NeeppLightSampler::Weights(uint32_t voxel) const {
    const std::span<const uint8_t> row = Row(voxel);
    std::vector<double> weights(groups_.Size());
    for (uint32_t g = 0; g < weights.size(); ++g) weights[g] = double(std::max(GroupVisibility(row, g), params_.floor));
    return weights;
}

void NeeppLightSampler::Report(nlohmann::ordered_json &report) const {
    report["parameters"] = EffectiveParamsText(params_);
    GroupLightSampler::Report(report);
    rows_.Report(report, prepareSeconds_);
    report["targets"] = targets_.Size();
    report["visibilityRays"] = (rows_.Filled() + rows_.Discarded()) * targets_.Size() * params_.samples;
    report["bytes"] = rows_.Bytes() + targets_.Bytes() + cdfs_.Bytes();
}

void NeeppLightSampler::Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const {
    Float mean = 0;
    uint32_t voxel = grid_.Index(query.p), visible = 0;
    if (IsPrepared()) {
        std::span<const uint8_t> row = Row(voxel);
        for (uint32_t g = 0; g < groups_.Size(); ++g) {
            Float v = GroupVisibility(row, g);
            mean += v / Float(groups_.Size());
            visible += v > 0;
        }
    }
    values.push_back({"voxel", double(voxel), true});
    values.push_back({"groups with any visibility", double(visible), false});
    values.push_back({"mean visibility of the groups", double(mean), false});
}

}  // namespace ext

void register_neepp(pbrt::PluginRegistry &registry) {
    using namespace ext;
    registry.Add<NeeppLightSampler, NeeppParams>(
        "neepp", "Visibility between voxels (NEE++, Guo et al. 2020); neither power nor distance counts.");
}
