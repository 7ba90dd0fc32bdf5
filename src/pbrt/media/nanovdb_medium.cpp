#include "pbrt/media/nanovdb_medium.h"

#include <array>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <iostream>  // NanoVDB needs it

#include "pbrt/core/error.h"
#include "pbrt/core/memory.h"

// The only file that sees NanoVDB.
#define NANOVDB_USE_ZIP
#define NANOVDB_USE_BLOSC
#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/GridValidator.h>
#include <nanovdb/util/IO.h>

namespace pbrt {

namespace {

using FloatGrid = nanovdb::NanoGrid<float>;
using Accessor = nanovdb::DefaultReadAccessor<float>;
using Handle = nanovdb::GridHandle<nanovdb::HostBuffer>;

/// Throws UserError if the file is not one that this version of NanoVDB reads.
void CheckMagic(const std::string &path) {
    std::ifstream file(path, std::ios::binary);
    std::error_code none;
    if (!file || std::filesystem::is_directory(path, none))
        throw UserError(fmt::format("{}: the file cannot be opened.", path));
    std::array<char, 8> magic{};
    file.read(magic.data(), magic.size());
    const std::string_view found(magic.data(), static_cast<size_t>(file.gcount()));
    if (found == "NanoVDB0") return;
    if (found.starts_with("NanoVDB"))
        throw UserError(
            fmt::format("{}: the file was written by a newer version of NanoVDB (it begins with \"{}\"); "
                        "versions up to {}, whose files begin with \"NanoVDB0\", can be read.",
                        path, found, NANOVDB_MAJOR_VERSION_NUMBER));
    if (found.starts_with(" BDV"))
        throw UserError(
            fmt::format("{}: this is an OpenVDB file; the program nanovdb_convert turns it into a NanoVDB "
                        "file.",
                        path));
    throw UserError(fmt::format("{}: this is not a NanoVDB file.", path));
}

/// One grid of a file, with its memory. Empty if the file has no such grid.
class VdbGrid {
  public:
    VdbGrid() = default;
    VdbGrid(const std::string &path, const nanovdb::io::GridMetaData &data) {
        const std::string what = fmt::format("{}: grid \"{}\"", path, Abbreviate(data.gridName));
        if (data.gridType != nanovdb::GridType::Float)
            throw UserError(fmt::format("{} holds values of type {}; only float is possible.", what,
                                        nanovdb::toStr(data.gridType)));
        RequireMemory(static_cast<double>(data.gridSize), what, {});
        handle_ = nanovdb::io::readGrid(path, data.gridName);
        grid_ = handle_.grid<float>();
        if (!grid_ || !nanovdb::isValid(*grid_)) throw UserError(what + " is damaged.");
    }
    explicit operator bool() const { return grid_ != nullptr; }
    const FloatGrid &operator*() const { return *grid_; }
    const FloatGrid *operator->() const { return grid_; }
    size_t Bytes() const { return handle_.size(); }

    AffineMap IndexFromWorld() const {
        auto at = [this](double x, double y, double z) {
            const nanovdb::Vec3d p = grid_->worldToIndex(nanovdb::Vec3d(x, y, z));
            return glm::dvec3(p[0], p[1], p[2]);
        };
        const glm::dvec3 o = at(0, 0, 0);
        return {glm::dmat3(at(1, 0, 0) - o, at(0, 1, 0) - o, at(0, 0, 1) - o), o};
    }

  private:
    Handle handle_;
    const FloatGrid *grid_ = nullptr;
};

struct VdbGrids {
    VdbGrid density, temperature;
};

VdbGrids ReadGrids(const NanoVdbRequest &request) {
    CheckMagic(request.path);
    VdbGrids grids;
    try {
        std::vector<std::string> names;
        for (const nanovdb::io::GridMetaData &data : nanovdb::io::readGridMetaData(request.path)) {
            names.push_back(data.gridName);
            if (data.gridName == request.densityName && !grids.density) grids.density = VdbGrid(request.path, data);
            if (data.gridName == request.temperatureName && !grids.temperature)
                grids.temperature = VdbGrid(request.path, data);
        }
        if (!grids.density)
            throw UserError(fmt::format("{}: the file has no grid \"{}\"; {}.", request.path,
                                        Abbreviate(request.densityName), ListChoices(request.densityName, names)));
    } catch (const UserError &) {
        throw;
    } catch (const std::exception &e) {  // NanoVDB's own, and memory for sizes that are nonsense
        throw UserError(fmt::format("{}: the file is damaged or cannot be read: {}.", request.path, e.what()));
    }
    return grids;
}

Float Interpolate(const Accessor &accessor, const Point3 &p) {
    const Vector3 low = glm::floor(p), w = p - low;
    const nanovdb::Coord first(static_cast<int>(low.x), static_cast<int>(low.y), static_cast<int>(low.z));
    std::array<Float, 4> alongZ;
    for (int i = 0; i < 4; ++i) {
        const nanovdb::Coord at = first.offsetBy(i & 1, i >> 1, 0);
        alongZ[static_cast<size_t>(i)] = Lerp(w.z, accessor.getValue(at), accessor.getValue(at.offsetBy(0, 0, 1)));
    }
    return Lerp(w.y, Lerp(w.x, alongZ[0], alongZ[1]), Lerp(w.x, alongZ[2], alongZ[3]));
}

/// The largest value from index `low` to `high`, both included; at least 0. False if one is not finite.
bool FindMax(const Accessor &accessor, const glm::ivec3 &low, const glm::ivec3 &high, Float *max) {
    *max = 0;
    // Leaves are cubes of 8^3 voxels; where there is none, all voxels of such a cube have the same value.
    constexpr int kLeaf = 8;
    auto take = [&](Float v) {
        *max = std::max(*max, v);
        return std::isfinite(v);
    };
    auto startOf = [](int i) { return i & ~(kLeaf - 1); };
    for (int z = startOf(low.z); z <= high.z; z += kLeaf)
        for (int y = startOf(low.y); y <= high.y; y += kLeaf)
            for (int x = startOf(low.x); x <= high.x; x += kLeaf) {
                const nanovdb::Coord corner(x, y, z);
                const auto *leaf = accessor.probeLeaf(corner);
                if (!leaf) {
                    if (!take(accessor.getValue(corner))) return false;
                    continue;
                }
                const glm::ivec3 begin = glm::max(low, glm::ivec3(x, y, z));
                const glm::ivec3 end = glm::min(high, glm::ivec3(x, y, z) + (kLeaf - 1));
                for (int i = begin.x; i <= end.x; ++i)
                    for (int j = begin.y; j <= end.y; ++j)
                        for (int k = begin.z; k <= end.z; ++k)
                            if (!take(leaf->getValue(nanovdb::Coord(i, j, k)))) return false;
            }
    return true;
}

class NanoVdbMedium final : public Medium {
  public:
    NanoVdbMedium(const NanoVdbRequest &request, VdbGrids grids, MediumSpectra spectra, Float g,
                  const Transform &renderFromMedium)
        : Medium(g, grids.temperature && request.thermal.scale > 0 && spectra.absorption.MaxValue() > 0),
          spectra_(std::move(spectra)),
          grids_(std::move(grids)),
          thermal_(request.thermal) {
        const AffineMap mediumFromRender = AffineMap(glm::dmat4(renderFromMedium.Matrix())).Inverse();
        const auto &box = grids_.density->indexBBox();
        // Values fade to the background over one voxel around the active ones.
        low_ = glm::ivec3(box.min()[0], box.min()[1], box.min()[2]) - 1;
        const glm::ivec3 high = glm::ivec3(box.max()[0], box.max()[1], box.max()[2]) + 1;
        const glm::ivec3 cells = glm::min(high - low_, glm::ivec3(kMaxCells));
        indicesPerCell_ = Vector3(high - low_) / Vector3(cells);
        gridFromRender_ = AffineMap::ToBox(low_, high, cells) * grids_.density.IndexFromWorld() * mediumFromRender;
        if (grids_.temperature) temperatureFromRender_ = grids_.temperature.IndexFromWorld() * mediumFromRender;
        std::atomic<bool> isFinite = true;
        majorants_ = MajorantGrid(cells, [&](const glm::ivec3 &cell) -> Float {
            Float max = 0;
            const Point3 first = ToIndex(Point3(cell)), last = ToIndex(Point3(cell + 1));
            if (!FindMax(grids_.density->getAccessor(), glm::ivec3(glm::floor(first)), glm::ivec3(glm::floor(last)) + 1,
                         &max)) {
                isFinite = false;
                return 0;
            }
            return kMajorantSlack * max;
        });
        if (!isFinite)
            throw UserError(fmt::format("{}: grid \"{}\" holds a density that is not a number or infinite.",
                                        request.path, Abbreviate(request.densityName)));
    }

    size_t Bytes() const override {
        return sizeof(*this) + spectra_.Bytes() + majorants_.Bytes() + grids_.density.Bytes() +
               grids_.temperature.Bytes();
    }

    MediumOnRay On(const Ray &ray, Float tMax, const SampledWavelengths &lambda) const override {
        const MediumCoefficients unit = spectra_.Sample(lambda);
        MediumOnRay onRay(*this, GridWalk(majorants_, gridFromRender_, ray, tMax), lambda, unit,
                          unit.absorption + unit.scattering);
        const VdbGrid &temperature = grids_.temperature ? grids_.temperature : grids_.density;
        OnRay &memory = onRay.MakeMemory(OnRay{grids_.density->getAccessor(), temperature->getAccessor(), {}, {}});
        if (IsEmissive() && onRay.Walk().Anchor() < Infinity) {
            const glm::dvec3 d(ray.d);
            memory.origin = Point3(
                temperatureFromRender_.Point(glm::dvec3(ray.o) + d * static_cast<double>(onRay.Walk().Anchor())));
            memory.direction = Vector3(temperatureFromRender_.Vector(d));
        }
        return onRay;
    }

  private:
    /// What is kept along a ray: the nodes of the trees that were read last, and the ray in the index space of the
    /// temperature, where it starts at the anchor of the walk.
    struct OnRay {
        Accessor density, temperature;
        Point3 origin;
        Vector3 direction;
    };
    static constexpr int kMaxCells = 64;

    /// From the coordinates of the majorants to those of the density's index space; see Voxels::ToVoxels.
    Point3 ToIndex(const Point3 &p) const {
        return {std::fma(p.x, indicesPerCell_.x, static_cast<Float>(low_.x)),
                std::fma(p.y, indicesPerCell_.y, static_cast<Float>(low_.y)),
                std::fma(p.z, indicesPerCell_.z, static_cast<Float>(low_.z))};
    }

    MediumCoefficients Evaluate(MediumOnRay &onRay, Float t) const override {
        const OnRay &memory = onRay.Memory<OnRay>();
        const Float density = std::max(Float(0), Interpolate(memory.density, ToIndex(onRay.Walk().At(t))));
        MediumCoefficients c = onRay.Unit();
        c.absorption *= density;
        c.scattering *= density;
        if (IsEmissive() && density > 0) {
            const Point3 p = memory.origin + memory.direction * (t - onRay.Walk().Anchor());
            c.emission = thermal_.At(Interpolate(memory.temperature, p), onRay.Lambda());
        }
        return c;
    }

    MediumSpectra spectra_;
    VdbGrids grids_;
    ThermalEmission thermal_;
    glm::ivec3 low_{0};  ///< index coordinates of the low corner of the majorants
    Vector3 indicesPerCell_{};
    MajorantGrid majorants_;
    AffineMap gridFromRender_, temperatureFromRender_;
};

}  // namespace

std::unique_ptr<Medium> MakeNanoVdbMedium(const NanoVdbRequest &request, MediumSpectra spectra, Float g,
                                          const Transform &renderFromMedium) {
    VdbGrids grids = ReadGrids(request);
    if (grids.density->isEmpty())
        throw UserError(fmt::format("{}: grid \"{}\" is empty.", request.path, Abbreviate(request.densityName)));
    return std::make_unique<NanoVdbMedium>(request, std::move(grids), std::move(spectra), g, renderFromMedium);
}

}  // namespace pbrt
