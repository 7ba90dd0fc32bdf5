#include "ext/baselines/neepp/visibility_map.h"

#include <nlohmann/json.hpp>

#include "pbrt/core/log.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/seconds_since.h"

namespace ext {

namespace {
/// Decorrelates the segments from other uses of the seed.
constexpr uint64_t kStream = 0x6e65657070ull;

Vector3 Uniform3(Rng &rng) {
    Float x = rng.Uniform(), y = rng.Uniform();
    return {x, y, rng.Uniform()};
}
}  // namespace

void VisibilityMap::Prepare(PrepareContext &context, const LightGroups &groups) {
    const auto start = std::chrono::steady_clock::now();
    scene_ = &context.scene;
    seed_ = context.seed;
    grid_ = VoxelGrid(context.scene.Bounds(), voxels_);
    targets_ = LightTargets(context.scene, grid_, groups);
    rows_.Reset(grid_.Size(), targets_.Size());
    auto work = static_cast<double>(grid_.BorderSize()) * static_cast<double>(targets_.Size()) * samples_;
    if (work > 3e8)
        LogWarning(
            fmt::format("neepp: visibility to {} voxels and directions with lights takes about {:.1e} rays, {} for "
                        "every voxel that a path enters for the first time.",
                        targets_.Size(), work, targets_.Size() * static_cast<size_t>(samples_)));
    prepareSeconds_ = SecondsSince(start);
}

void VisibilityMap::TestSegments(uint32_t voxel, std::span<uint8_t> row) const {
    // Scene::Occluded would count these as shadow rays of the render.
    const Accel &accel = scene_->Acceleration();
    for (uint32_t t = 0; t < row.size(); ++t) {
        const LightTargets::Target &target = targets_[t];
        Rng rng(Hash(kStream, seed_, voxel, t));
        int freeSegments = 0;
        for (int i = 0; i < samples_; ++i) {
            Ray ray;
            ray.o = grid_.PointIn(voxel, Uniform3(rng));
            switch (target.kind) {
                case LightTargets::Kind::Voxel:
                    ray.d = grid_.PointIn(target.index, Uniform3(rng)) - ray.o;
                    ray.tMax = 1;
                    break;
                case LightTargets::Kind::Direction: ray.d = target.direction; break;
                case LightTargets::Kind::SkyPart:
                    ray.d = LightTargets::DirectionIn(target.index, rng.Uniform2());
                    break;
            }
            freeSegments += ray.d == Vector3(0) || !accel.Occluded(ray);
        }
        row[t] = static_cast<uint8_t>(freeSegments);
    }
}

Float VisibilityMap::GroupVisibility(std::span<const uint8_t> row, uint32_t group) const {
    Float sum = 0;
    for (const LightTargets::Share &s : targets_.SharesOf(group)) sum += s.weight * static_cast<Float>(row[s.target]);
    return std::min(Float(1), sum / static_cast<Float>(samples_));
}

void VisibilityMap::Report(nlohmann::ordered_json &report) const {
    report["prepassSeconds"] = 0.0;
    // Voxels are filled during rendering; a thread that fills does not render.
    report["buildSeconds"] = prepareSeconds_ + rows_.FillThreadSeconds() / std::max(1, ThreadCount());
    report["fillThreadSeconds"] = rows_.FillThreadSeconds();
    report["voxels"] = rows_.Size();
    report["voxelsFilled"] = rows_.Filled();
    report["voxelsFilledTwice"] = rows_.Discarded();
    report["targets"] = targets_.Size();
    report["visibilityRays"] = (rows_.Filled() + rows_.Discarded()) * targets_.Size() * static_cast<size_t>(samples_);
    report["bytes"] = rows_.Bytes() + targets_.Bytes();
}

std::string VisibilityMap::Describe() const {
    const glm::ivec3 &r = grid_.Resolution();
    const Vector3 &s = grid_.VoxelSize();
    size_t voxels = 0, directions = 0;
    for (size_t i = 0; i < targets_.Size(); ++i)
        ++(targets_[i].kind == LightTargets::Kind::Voxel ? voxels : directions);
    return fmt::format(
        "grid of {} x {} x {} voxels, {:.4g} x {:.4g} x {:.4g} each\n"
        "lights in {} voxels and {} directions out of the scene, {} segments to each\n"
        "{} of {} voxels filled, {} KB, {:.3f} s of thread time to fill them\n",
        r.x, r.y, r.z, s.x, s.y, s.z, voxels, directions, samples_, rows_.Filled(), rows_.Size(),
        (rows_.Bytes() + targets_.Bytes()) / 1000, rows_.FillThreadSeconds());
}

}  // namespace ext
