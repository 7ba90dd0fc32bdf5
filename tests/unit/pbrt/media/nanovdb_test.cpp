#include <gtest/gtest.h>

#include <iostream>

#include "media_test_support.h"
#include "pbrt/core/files.h"
#include "pbrt/media/medium_kinds.h"
#include "support/errors.h"
#include "support/folder_test.h"

// The same as where the renderer includes it, because its functions are inline.
#define NANOVDB_USE_ZIP
#define NANOVDB_USE_BLOSC
#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/GridChecksum.h>
#include <nanovdb/util/IO.h>

namespace pbrt::test {
namespace {

class NanoVdbMedium : public FolderTest {};

/// A grid of random values in some voxels, of a size that has a tree of several leaves.
nanovdb::GridHandle<> RandomGrid(const std::string &name, uint64_t seed, Float factor, double voxel,
                                 const nanovdb::Vec3d &origin) {
    nanovdb::GridBuilder<float> builder(0.f, nanovdb::GridClass::FogVolume);
    auto accessor = builder.getAccessor();
    Rng rng(seed);
    for (int i = 0; i < 3000; ++i)
        accessor.setValue({int(rng.UniformInt(25)) - 7, int(rng.UniformInt(12)) + 3, int(rng.UniformInt(18)) - 30},
                          factor * (rng.Uniform() + 0.1f));
    return builder.getHandle<>(voxel, origin, name);
}

void ExpectNanoVdbComplaint(const ParamSet &params, int line, const std::string &part) {
    DiagnosticSink sink;
    const Diagnostic error = ErrorOf([&] { MakeMedium("nanovdb", params, {}, sink); });
    EXPECT_EQ(error.loc.line, line) << error.message;
    ExpectWords(error.message, {part});
    EXPECT_EQ(error.message.find('\n'), std::string::npos) << error.message;
}

TEST_F(NanoVdbMedium, ValuesAreThoseOfTheVoxels) {
    auto handle = nanovdb::io::readGrid(kBlob, std::string("density"));
    const auto *grid = handle.grid<float>();
    ASSERT_TRUE(grid);
    const Transform place = Places()[1];
    const auto medium = MakeMedium("nanovdb", Params().String("filename", kBlob), place);
    EXPECT_FALSE(medium->IsEmissive());
    EXPECT_GT(medium->Bytes(), 300000u);
    const auto box = grid->indexBBox();
    const auto accessor = grid->getAccessor();
    int inside = 0;
    Rng rng(2);
    for (int i = 0; i < 5000; ++i) {
        const nanovdb::Coord at(box.min()[0] + int(rng.UniformInt(uint32_t(box.dim()[0]))),
                                box.min()[1] + int(rng.UniformInt(uint32_t(box.dim()[1]))),
                                box.min()[2] + int(rng.UniformInt(uint32_t(box.dim()[2]))));
        const nanovdb::Vec3d world = grid->indexToWorld(nanovdb::Vec3d(at[0], at[1], at[2]));
        const Point3 p{Float(world[0]), Float(world[1]), Float(world[2])};
        const Float value = accessor.getValue(at);
        inside += value > 0;
        EXPECT_NEAR(medium->At(place.Point(p), kLambda).absorption[0], value, 1e-3f);
    }
    EXPECT_GT(inside, 1000);
}

TEST_F(NanoVdbMedium, DensityAndTemperatureWithTransformationsOfTheirOwn) {
    std::vector<nanovdb::GridHandle<>> handles;
    handles.push_back(RandomGrid("fog", 1, 1, 0.1, {1, 2, 3}));
    handles.push_back(RandomGrid("heat", 2, 2000, 0.13, {0.8, 1.9, 3.5}));
    const auto *density = handles[0].grid<float>(), *heat = handles[1].grid<float>();
    auto interpolate = [](const nanovdb::NanoGrid<float> &grid, const Point3 &p) {
        const nanovdb::Vec3d v = grid.worldToIndex(nanovdb::Vec3d(double(p.x), double(p.y), double(p.z)));
        const auto accessor = grid.getAccessor();
        double sum = 0;
        for (int i = 0; i < 8; ++i) {
            double weight = 1;
            nanovdb::Coord at;
            for (int a = 0; a < 3; ++a) {
                const double low = std::floor(v[a]), w = v[a] - low;
                at[a] = int(low) + ((i >> a) & 1);
                weight *= (i >> a) & 1 ? w : 1 - w;
            }
            sum += weight * double(accessor.getValue(at));
        }
        return sum;
    };
    const nanovdb::BBox<nanovdb::Vec3R> box = density->worldBBox();
    const Bounds3 bounds(Point3(float(box.min()[0]), float(box.min()[1]), float(box.min()[2])),
                         Point3(float(box.max()[0]), float(box.max()[1]), float(box.max()[2])));
    for (auto codec : {nanovdb::io::Codec::NONE, nanovdb::io::Codec::ZIP, nanovdb::io::Codec::BLOSC}) {
        const std::string file = Path("grids.nvdb");
        nanovdb::io::writeGrids(file, handles, codec);
        Params p;
        p.String("filename", file).String("gridname", "fog").String("temperaturename", "heat");
        p.Number("Lescale", 2).Number("temperaturescale", 3).Number("temperaturecutoff", 50);
        const auto medium = MakeMedium("nanovdb", p);
        EXPECT_TRUE(medium->IsEmissive());
        Rng rng(3);
        int hot = 0;
        for (int i = 0; i < 3000; ++i) {
            const Point3 at = PointNear(bounds, rng, 0.2f);
            const MediumCoefficients c = medium->At(at, kLambda);
            const double d = interpolate(*density, at);
            ASSERT_NEAR(double(c.absorption[0]), d, 1e-4);
            ASSERT_NEAR(double(c.scattering[3]), d, 1e-4);
            if (d <= 1e-3) continue;
            const Float kelvin = (Float(interpolate(*heat, at)) - 50) * 3;
            if (std::abs(kelvin - 100) < 1) continue;
            hot += kelvin > 100;
            const Float expected = kelvin > 100 ? 2 * BlackbodySpectrum(kelvin).Sample(kLambda)[1] : 0;
            ASSERT_NEAR(c.emission[1], expected, 2e-3f * expected + 1e-6f);
        }
        EXPECT_GT(hot, 300);
        // Majorants hold for a sparse grid with hard edges, too, and its outermost voxels count.
        double tightest = 0;
        for (int i = 0; i < 3000; ++i) {
            const Ray ray = RayThrough(PointNear(bounds, rng, 0.5f), PointNear(bounds, rng));
            MediumOnRay onRay = medium->On(ray, Infinity, kLambda);
            MajorantSegment s;
            while (onRay.Next(&s))
                for (int k = 0; k < 5; ++k) {
                    const MediumCoefficients c = onRay.At(std::min(Lerp(rng.Uniform(), s.begin, s.end), s.end));
                    ASSERT_LE(c.absorption[0] + c.scattering[0], s.majorant[0]);
                    tightest = std::max(tightest, double((c.absorption[0] + c.scattering[0]) / s.majorant[0]));
                }
        }
        EXPECT_GT(tightest, 0.9);
        // A grid of temperatures that is not there makes no light.
        EXPECT_FALSE(MakeMedium("nanovdb", Params().String("filename", file).String("gridname", "fog"))->IsEmissive());
    }
}

TEST_F(NanoVdbMedium, GridsThatAreNotThereAreErrors) {
    ExpectNanoVdbComplaint(Params().String("filename", kBlob).String("gridname", "densitty"), 1,
                           "did you mean \"density\"");
    ExpectNanoVdbComplaint(Params(), 100, "filename");
    ExpectNanoVdbComplaint(Params().String("filename", "/nowhere/smoke.nvdb"), 1, "cannot be opened");
    ExpectNanoVdbComplaint(Params().String("filename", "/tmp"), 1, "cannot be opened");
    ExpectNanoVdbComplaint(
        Params().String("filename", kBlob).Number("temperatureoffset", 1).Number("temperaturecutoff", 1), 3,
        "the same parameter");
}

TEST_F(NanoVdbMedium, LevelSetsAreErrors) {
    nanovdb::GridBuilder<float> builder(1.f, nanovdb::GridClass::LevelSet);
    builder.getAccessor().setValue({1, 2, 3}, 0.5f);
    nanovdb::io::writeGrid(Path("set.nvdb"), builder.getHandle<>(1.0, nanovdb::Vec3d(0), "density"));
    ExpectNanoVdbComplaint(Params().String("filename", Path("set.nvdb")), 1, "only fog volumes");
}

TEST_F(NanoVdbMedium, BrokenFilesAreErrors) {
    const std::string blob = ReadFileContents(kBlob);
    ASSERT_GT(blob.size(), 100000u);
    auto expect = [&](const std::string &content, const std::string &part) {
        ExpectNanoVdbComplaint(Params().String("filename", Write("broken.nvdb", content)), 1, part);
    };
    std::string newer = blob;
    newer[7] = '2';
    expect(newer, "newer version of NanoVDB");
    std::string openVdb = blob;
    openVdb.replace(0, 4, " BDV");
    expect(openVdb, "OpenVDB");
    expect("", "not a NanoVDB file");
    expect("P6 3 3 255", "not a NanoVDB file");
    expect(blob.substr(0, 40), "damaged");
    expect(blob.substr(0, blob.size() / 2), "damaged");
    expect(blob.substr(0, 8), "has no grid");
    // The blob has no checksum, so a value that is another one cannot be noticed; whatever else is wrong must not do
    // worse than make an error.
    Rng rng(4);
    int errors = 0;
    for (int i = 0; i < 400; ++i) {
        std::string flipped = blob;
        const size_t at = 8 + rng.UniformInt(uint32_t(i % 2 ? flipped.size() - 8 : 2000));
        flipped[at] = char(flipped[at] ^ (1 + rng.UniformInt(255)));
        DiagnosticSink sink;
        try {
            const Params params = Params().String("filename", Write("flipped.nvdb", flipped));
            const auto medium = MakeMedium("nanovdb", params, {}, sink);
            MediumOnRay onRay = medium->On(RayThrough({-2, 0.1f, 0.2f}, {2, 0.2f, 0.1f}), Infinity, kLambda);
            for (MajorantSegment s; onRay.Next(&s);) EXPECT_GE(onRay.At(s.begin).absorption[0], 0);
        } catch (const UserError &) {
            ++errors;
        }
    }
    EXPECT_GT(errors, 20);
    // With a checksum every value counts.
    auto summed = RandomGrid("density", 1, 1, 1, nanovdb::Vec3d(0));
    nanovdb::updateChecksum(*summed.grid<float>(), nanovdb::ChecksumMode::Full);
    nanovdb::io::writeGrid(Path("sum.nvdb"), summed);
    const std::string sound = ReadFileContents(Path("sum.nvdb"));
    ASSERT_TRUE(MakeMedium("nanovdb", Params().String("filename", Path("sum.nvdb"))));
    for (size_t at = sound.size() - 900; at < sound.size(); at += 100) {
        std::string flipped = sound;
        flipped[at] = char(flipped[at] ^ 0x55);
        expect(flipped, "is damaged");
    }
}

TEST_F(NanoVdbMedium, DensitiesThatAreNoNumbersAreErrors) {
    nanovdb::GridBuilder<float> builder(0.f);
    builder.getAccessor().setValue({1, 2, 3}, std::numeric_limits<float>::infinity());
    builder.getAccessor().setValue({4, 2, 3}, 1);
    nanovdb::io::writeGrid(Path("infinite.nvdb"), builder.getHandle<>(1.0, nanovdb::Vec3d(0), "density"));
    ExpectNanoVdbComplaint(Params().String("filename", Path("infinite.nvdb")), 1, "not a number or infinite");
}

}  // namespace
}  // namespace pbrt::test
