#include "pbrt/shapes/shape_factory.h"

#include <zlib.h>

#include "pbrt/images/image.h"
#include "pbrt/shapes/curves.h"
#include "pbrt/shapes/mesh_sources.h"
#include "shape_cases.h"
#include "support/errors.h"
#include "support/folder_test.h"
#include "support/given_params.h"

namespace pbrt::test {
namespace {

class ShapeFactory : public FolderTest {
  protected:
    Params &Points(std::vector<Float> p) { return params.Floats(ParamType::Point3, "P", std::move(p)); }
    ShapeList Make(const char *type) { return Make(type, params, sink); }
    static ShapeList Make(const char *type, const ParamSet &p, DiagnosticSink &sink, const FileResolver &files = {},
                          const Transform &t = {}, const Displacement *displacement = nullptr) {
        return Shapes().Make(type, p, ShapeContext{t, false, files, sink, ParamReader(p), displacement});
    }
    std::string ErrorOf(const char *type) {
        return MessageOf([&] { Make(type); });
    }
    size_t Unused() { return sink.ErrorCount(); }
    const std::vector<Float> square = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    Params params{"Shape"};
    DiagnosticSink sink;
};

TEST_F(ShapeFactory, ThreePointsNeedNoIndices) {
    Points({0, 0, 0, 1, 0, 0, 0, 1, 0});
    auto shapes = Make("trianglemesh");
    ASSERT_EQ(shapes.size(), 1u);
    EXPECT_EQ(shapes[0]->PrimitiveCount(), 1u);
    EXPECT_EQ(shapes[0]->Kind(), ShapeKind::TriangleMesh);
    EXPECT_TRUE(sink.All().empty());
}

TEST_F(ShapeFactory, FourPointsWithoutIndicesAreOnePatchButNotTriangles) {
    Points(square);
    EXPECT_EQ(Make("bilinearmesh")[0]->Kind(), ShapeKind::BilinearMesh);
    ExpectWords(ErrorOf("trianglemesh"), {"indices"});
}

TEST_F(ShapeFactory, ExcessIndicesAreDroppedWithAWarning) {
    Points(square).Integers("indices", {0, 1, 2, 2, 1, 3, 0, 1});
    EXPECT_EQ(Make("trianglemesh")[0]->PrimitiveCount(), 2u);
    EXPECT_EQ(Make("loopsubdiv")[0]->PrimitiveCount(), 128u);
    ASSERT_EQ(sink.All().size(), 2u);
    for (const Diagnostic &d : sink.All()) {
        EXPECT_EQ(d.severity, Severity::Warning);
        ExpectWords(d.message, {"(8) is not a multiple of 3; the last 2 are dropped"});
    }
}

TEST_F(ShapeFactory, ArraysOfTheWrongLengthAreDiscardedWithAWarning) {
    Points(square)
        .Integers("indices", {0, 1, 2})
        .Floats(ParamType::Normal, "N", {0, 0, 1})
        .Floats(ParamType::Vector3, "S", {0, 0, 1})
        .Floats(ParamType::Point2, "uv", {0, 0, 1, 0})
        .Integers("faceIndices", {1, 2});
    auto shapes = Make("trianglemesh");
    const MeshData &data = static_cast<const TriangleMesh &>(*shapes[0]).Data();
    EXPECT_TRUE(data.n.empty() && data.s.empty() && data.uv.empty());
    ASSERT_EQ(sink.All().size(), 4u);
    ExpectWords(sink.All()[0].message, {"\"N\" has 1 entry for 4 points"});
    ExpectWords(sink.All()[3].message, {"\"faceIndices\" has 2 entries for 1 face;"});
    EXPECT_FALSE(sink.HasErrors());
    EXPECT_EQ(Unused(), 0u);
}

TEST_F(ShapeFactory, BadMeshesAreErrors) {
    ExpectWords(ErrorOf("trianglemesh"), {"\"point3 P\""});
    Points(square).Integers("indices", {0, 1, 7});
    ExpectWords(ErrorOf("trianglemesh"), {"7"});
    params.Integers("indices", {0, 1, -1});
    ExpectWords(ErrorOf("trianglemesh"), {"-1"});
}

TEST_F(ShapeFactory, PatchesDoNotReadTangents) {
    Points(square).Floats(ParamType::Vector3, "S", square);
    Make("bilinearmesh");
    EXPECT_EQ(Unused(), 1u);
    params.String("emissionfilename", "/nonexistent/x.exr");
    ExpectWords(ErrorOf("bilinearmesh"), {"/nonexistent/x.exr"});
}

// An image of 4 x 2 pixels with one bright pixel in the lower row, second column. Bilinear interpolation spreads its
// light by half a pixel.
TEST_F(ShapeFactory, EmissionImagesSetTheDensityOnAPatch) {
    const std::string file = Path("emission.exr");
    Image image(PixelFormat::Float, {4, 2}, {"R", "G", "B"});
    image.Set({1, 1}, 1, 8);
    WriteImage(file, image);
    Points(square).String("emissionfilename", file);
    auto shapes = Make("bilinearmesh");
    EXPECT_EQ(Unused(), 0u);
    int inside = 0, near = 0;
    constexpr int kSamples = 4000;
    Rng rng(4);
    for (int i = 0; i < kSamples; ++i) {
        auto s = shapes[0]->SampleArea(0, rng.Uniform2());
        ASSERT_TRUE(s && s->pdf > 0);
        inside += s->p.x > 0.25f && s->p.x < 0.5f && s->p.y < 0.5f;
        near += s->p.x < 0.75f;
    }
    // 1 % of the samples go everywhere, because the light may shine where this image is black.
    EXPECT_NEAR(near / double(kSamples), 0.99 + 0.01 * 0.75, 3e-3);
    EXPECT_LT(near, kSamples);
    // The image is clamped at its lower edge, so 7/8 of the light lies within the row, and 3/4 within the column.
    EXPECT_NEAR(inside / double(kSamples), 0.75 * 7 / 8, 0.03);
    image.Set({1, 1}, 1, 0);
    WriteImage(file, image);
    Make("bilinearmesh");
    ASSERT_EQ(sink.All().size(), 1u);
    ExpectWords(sink.All()[0].message, {"black"});
}

TEST_F(ShapeFactory, EmissionImagesAreIgnoredOnMeshesWithUv) {
    Points(square)
        .Floats(ParamType::Point2, "uv", {0, 0, 1, 0, 0, 1, 1, 1})
        .String("emissionfilename", "/nonexistent/x.exr");
    Make("bilinearmesh");
    ASSERT_EQ(sink.All().size(), 1u);
    ExpectWords(sink.All()[0].message, {"ignored"});
    EXPECT_EQ(Unused(), 0u);
}

TEST_F(ShapeFactory, QuadricParameters) {
    params.Number("radius", 2).Number("zmin", -1).Number("zmax", 0.5f).Number("phimax", 90);
    EXPECT_NEAR(Make("sphere")[0]->Area(0), Pi / 2 * 2 * 1.5f, 1e-5);
    EXPECT_NEAR(Make("cylinder")[0]->Area(0), Pi / 2 * 2 * 1.5f, 1e-5);
    EXPECT_EQ(Unused(), 0u);
    params.Number("innerradius", 1).Number("height", 3);
    auto disk = Make("disk");
    EXPECT_NEAR(disk[0]->Area(0), Pi / 4 * 3, 1e-5);
    EXPECT_NEAR(disk[0]->SampleArea(0, {0.3f, 0.3f})->p.z, 3, 1e-6);
    params.Number("radius", -1);
    ExpectWords(ErrorOf("disk"), {"radius"});
}

TEST_F(ShapeFactory, CurvesAreCheckedAndWidthsRunAlongTheWholeCurve) {
    ExpectWords(ErrorOf("curve"), {"\"point3 P\""});
    Points({0, 0, 0, 1, 0, 0, 2, 1, 0, 3, 1, 0, 4, 0, 0});
    ExpectWords(ErrorOf("curve"), {"5 points"});
    params.Integer("degree", 2).Number("width0", 1).Number("width1", 3);
    auto shapes = Make("curve");
    const auto &curves = static_cast<const Curves &>(*shapes[0]);
    ASSERT_EQ(curves.SegmentCount(), 2u);
    EXPECT_FLOAT_EQ(curves.SegmentOfPrimitive(0).width1, 2);
    params.String("type", "ribbon");
    ExpectWords(ErrorOf("curve"), {"3 normals"});
    params.Floats(ParamType::Normal, "N", {0, 0, 1, 0, 1, 0, 1, 0, 0});
    EXPECT_EQ(static_cast<const Curves &>(*Make("curve")[0]).SegmentCount(), 2u);
    params.Integer("splitdepth", 4);
    Make("curve");
    EXPECT_EQ(Unused(), 0u);
    params.String("type", "tube");
    ExpectWords(ErrorOf("curve"), {"cylinder"});
}

TEST_F(ShapeFactory, UnknownTypes) { ExpectWords(ErrorOf("spher"), {"did you mean \"sphere\"", "bilinearmesh"}); }

TEST_F(ShapeFactory, PlyFilesPlainAndGzipWithTrianglesAndQuads) {
    const std::string text =
        PlyText(5, {"x", "y", "z"}, 3, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 2 2\n4 0 1 2 3\n3 1 2 4\n5 0 1 2 3 4\n");
    Write("plain.ply", text);
    gzFile gz = gzopen(Path("named_plain.ply").c_str(), "wb");  // compressed, although the name has no .gz
    gzputs(gz, text.c_str());
    gzclose(gz);
    FileResolver files(folder_);
    for (const char *name : {"plain.ply", "named_plain.ply"}) {
        DiagnosticSink warnings;
        auto shapes = Make("plymesh", Params().String("filename", name), warnings, files);
        ASSERT_EQ(shapes.size(), 2u);
        EXPECT_EQ(shapes[0]->Kind(), ShapeKind::TriangleMesh);
        EXPECT_EQ(shapes[1]->Kind(), ShapeKind::BilinearMesh);
        EXPECT_TRUE(static_cast<const BilinearMesh &>(*shapes[1]).IsRectangle(0));
        ASSERT_EQ(warnings.All().size(), 1u);
        ExpectWords(warnings.All()[0].message, {std::string(name) + ": ignores 1 face with neither"});
    }
}

TEST_F(ShapeFactory, PlyMistakes) {
    ExpectWords(ErrorOf("plymesh"), {"filename"});
    params.String("filename", "/nonexistent/file.ply");
    ExpectWords(ErrorOf("plymesh"), {"/nonexistent/file.ply"});
    params.Number("edgelength", 0);
    ExpectWords(ErrorOf("plymesh"), {"edgelength"});
}

TEST_F(ShapeFactory, DisplacementErrorsPointAtTheParameterToBlame) {
    auto lineOf = [&](bool withUv) {
        std::vector<std::string> properties = {"x", "y", "z", "nx", "ny", "nz"};
        if (withUv) properties.insert(properties.end(), {"u", "v"});
        const std::string corners =
            withUv ? "0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n0 1 0 0 0 1 0 1\n" : "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n";
        Params p;
        p.String("filename", Write("displaced.ply", PlyText(3, properties, 1, corners + "3 0 1 2\n")));
        p.Number("edgelength", 1e-6f).Add(StringParam("displacement", "bumps", ParamType::Texture));
        const Displacement flat{[](auto &...) { return Float(0); }, 1};
        return test::ErrorOf([&] { Make("plymesh", p, sink, {}, {}, &flat); }).loc.line;
    };
    EXPECT_EQ(lineOf(true), 2);
    EXPECT_EQ(lineOf(false), 3);
}

TEST_F(ShapeFactory, WhatEmbreeIsGivenLiesWithinItsReach) {
    const auto errorAt = [&](const char *type, const Transform &t) {
        return MessageOf([&] { Make(type, params, sink, {}, t); });
    };
    for (const char *type : {"sphere", "disk", "cylinder"}) {
        ExpectWords(errorAt(type, Transform::Scale({1e20f, 1e20f, 1e20f})), {"coordinates must be"});
        EXPECT_EQ(errorAt(type, Transform::Scale({1e17f, 1e17f, 1e17f})), "") << type;
    }
    Points({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 3, 0}).Integers("indices", {0, 1, 2});
    EXPECT_EQ(errorAt("trianglemesh", Transform::Scale({1e17f, 1e17f, 1})), "");
    ExpectWords(errorAt("trianglemesh", Transform::Scale({1, 4e17f, 1})),
                {"vertex 3", "(0, 1.2e+18, 0)", "-1e+18", "at most 1e+18"});
    ExpectWords(errorAt("curve", Transform::Scale({1e18f, 1e18f, 1})), {"coordinates must be"});
    params.Number("radius", 1e38f);
    ExpectWords(ErrorOf("sphere"), {"\"radius\"", "1e+38", "above 0", "at most 1e+18"});
}

TEST_F(ShapeFactory, ASubdivisionThatDoesNotFitIsNotBegun) {
    std::vector<int> indices;
    for (int i = 0; i < 100'000; ++i) indices.insert(indices.end(), {0, 1, 2});
    params.Integers("indices", indices);
    Points({0, 0, 0, 1, 0, 0, 0, 1, 0}).Integer("levels", 10);
    ExpectWords(ErrorOf("loopsubdiv"), {"1e+11 triangles", "42 TB"});
}

}  // namespace
}  // namespace pbrt::test
