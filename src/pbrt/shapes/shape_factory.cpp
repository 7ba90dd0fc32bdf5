#include "pbrt/shapes/shape_factory.h"

#include "pbrt/images/image.h"
#include "pbrt/shapes/bilinear_mesh.h"
#include "pbrt/shapes/curves.h"
#include "pbrt/shapes/extent.h"
#include "pbrt/shapes/quadric.h"

namespace pbrt {
namespace {

/// A shape of type S; its constructor ends in the transformation and orientation of the context.
template <class S, class... Args>
ShapeList One(const ShapeContext &context, Args... args) {
    ShapeList shapes;
    shapes.push_back(std::make_unique<S>(std::move(args)..., context.renderFromObject, context.reverseOrientation));
    return shapes;
}

constexpr Items kPoints{.type = ParamType::Point3, .isRequired = true};

/// Validated indices of whole faces; the rest is dropped with a warning. Throws UserError if one is out of range or no
/// face is left.
std::vector<uint32_t> WholeFaces(std::span<const int> indices, size_t corners, size_t points, const ParamSet &set,
                                 DiagnosticSink &sink) {
    const size_t excess = indices.size() % corners;
    if (excess != 0)
        set.Warn(sink, "indices",
                 fmt::format("the number of \"indices\" ({}) is not a multiple of {}; the last {} are dropped.",
                             indices.size(), corners, excess));
    std::vector<uint32_t> whole;
    for (int i : indices.first(indices.size() - excess)) {
        if (i < 0 || size_t(i) >= points)
            throw set.Error("indices", "index {} is out of range; there are {} points.", i, points);
        whole.push_back(uint32_t(i));
    }
    if (whole.empty()) throw set.Error("indices", "no complete face is left.");
    return whole;
}

struct MeshParams {
    MeshData mesh;
    std::span<const int> indices, faceIndices;
    void Describe(auto &&v) {
        v("indices", indices, "corner indices; optional for a single face");
        v("P", mesh.p, kPoints, "points");
        v("N", mesh.n, Items{ParamType::Normal}, "normal per point");
        v("uv", mesh.uv, Items{ParamType::Point2}, "texture coordinates per point");
        v("faceIndices", faceIndices, "accepted, not used (for Ptex only)");
    }
    /// Validated mesh with `corners` indices per face.
    MeshData Finish(const ParamSet &set, DiagnosticSink &sink, size_t corners) {
        if (indices.empty()) {
            if (mesh.p.size() != corners)
                throw set.Error("",
                                "\"integer indices\" is missing; it may be left out only for exactly {} "
                                "points, and there are {}.",
                                corners, mesh.p.size());
            for (size_t i = 0; i < corners; ++i) mesh.indices.push_back(uint32_t(i));
        } else mesh.indices = WholeFaces(indices, corners, mesh.p.size(), set, sink);
        // Stock pbrt-v4 reports arrays of the wrong length and continues without them.
        auto discardUnlessPer = [&](auto &values, size_t expected, const char *name, const char *what) {
            if (values.empty() || values.size() == expected) return;
            set.Warn(sink, name,
                     fmt::format("\"{}\" has {} for {}; it is discarded.", name,
                                 CountText(values.size(), "entry", "entries"), CountText(expected, what)));
            values = {};
        };
        discardUnlessPer(mesh.n, mesh.p.size(), "N", "point");
        discardUnlessPer(mesh.s, mesh.p.size(), "S", "point");
        discardUnlessPer(mesh.uv, mesh.p.size(), "uv", "point");
        discardUnlessPer(faceIndices, mesh.indices.size() / corners, "faceIndices", "face");
        return std::move(mesh);
    }
};

struct TriangleMeshParams : MeshParams {
    void Describe(auto &&v) {
        MeshParams::Describe(v);
        v("S", mesh.s, Items{ParamType::Vector3}, "tangent per point");
    }
};

struct BilinearMeshParams : MeshParams {
    std::string emissionFilename;
    void Describe(auto &&v) {
        MeshParams::Describe(v);
        v("emissionfilename", emissionFilename, "image over (u, v) that guides light sampling");
    }
};

/// Sampling density from image brightness over (u, v), v upwards; null, with a warning, if black. Cells average
/// bilinear lookups inside them, so that no emitting point has density 0.
std::shared_ptr<const PiecewiseConstant2D> EmissionDensity(const std::string &filename, const ParamSet &set,
                                                           const ShapeContext &context) {
    const Image image = ReadImage(context.files.Resolve(filename)).image;
    const Point2i n = image.Resolution();
    constexpr Float kWeights[3] = {Float(1) / 8, Float(3) / 4, Float(1) / 8};
    std::vector<Float> f;
    Float sum = 0;
    for (int y = n.y - 1; y >= 0; --y)
        for (int x = 0; x < n.x; ++x) {
            Float cell = 0;
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i)
                    for (int c = 0; c < std::min(image.ChannelCount(), 3); ++c)
                        cell += kWeights[i + 1] * kWeights[j + 1] *
                                std::max(Float(0), image.Get({x + i, y + j}, c, WrapMode::Clamp));
            f.push_back(cell);
            sum += cell;
        }
    if (!(sum > 0)) {
        set.Warn(context.sink, "emissionfilename", fmt::format("{} is black; it is ignored.", filename));
        return nullptr;
    }
    // One percent is uniform, because the light may emit where this image is black.
    const Float everywhere = sum / Float(f.size()) / 100;
    for (Float &cell : f) cell += everywhere;
    return std::make_shared<PiecewiseConstant2D>(f, n.x, n.y);
}

ShapeList MakeBilinearMesh(BilinearMeshParams p, const ParamSet &set, const ShapeContext &context) {
    MeshData mesh = p.Finish(set, context.sink, 4);
    std::shared_ptr<const PiecewiseConstant2D> emission;
    if (!p.emissionFilename.empty() && !mesh.uv.empty())
        set.Warn(context.sink, "emissionfilename",
                 "\"emissionfilename\" is ignored, because there are \"uv\" (as in stock).");
    else if (!p.emissionFilename.empty())
        emission = set.At("emissionfilename", [&] { return EmissionDensity(p.emissionFilename, set, context); });
    ShapeList shapes;
    shapes.push_back(std::make_unique<BilinearMesh>(std::move(mesh), context.renderFromObject,
                                                    context.reverseOrientation, std::move(emission)));
    return shapes;
}

constexpr NamedValue<CurveBasis> kBases[] = {{"bezier", CurveBasis::Bezier}, {"bspline", CurveBasis::BSpline}};
constexpr NamedValue<CurveKind> kCurveKinds[] = {
    {"flat", CurveKind::Flat}, {"cylinder", CurveKind::Cylinder}, {"ribbon", CurveKind::Ribbon}};

struct CurveParams {
    Float width = 1;
    std::optional<Float> width0, width1, splitDepth;
    int degree = 3, intSplitDepth = 3;
    CurveBasis basis = CurveBasis::Bezier;
    CurveKind kind = CurveKind::Flat;
    std::vector<Point3> points;
    std::vector<Normal3> normals;
    void Describe(auto &&v) {
        constexpr Range<Float> kWidthRange{0, kMaxCoordinate};
        v("P", points, kPoints, "control points");
        v("degree", degree, Range<int>{2, 3}, "degree of the curve");
        v("basis", basis, kBases, "meaning of the control points");
        v("type", kind, kCurveKinds, "kind of surface");
        v("width", width, kWidthRange, "width at both ends");
        v("width0", width0, kWidthRange, "width at the start; default: width");
        v("width1", width1, kWidthRange, "width at the end; default: width");
        v("N", normals, Items{ParamType::Normal}, "ribbon: normals at segment ends");
        v("splitdepth", intSplitDepth, "halvings of a segment to find hits");
        v("splitdepth", splitDepth, "the same as a float; overrides the integer");
    }
};

ShapeList MakeCurve(CurveParams p, const ParamSet &set, const ShapeContext &context) {
    const size_t count = SegmentCount(p.points.size(), p.degree, p.basis);
    if (count == 0)
        throw set.Error("P", p.basis == CurveBasis::Bezier
                                 ? fmt::format("there are {} points; a bezier curve of degree {} needs {} + {} k.",
                                               p.points.size(), p.degree, p.degree + 1, p.degree)
                                 : fmt::format("there are {} points; a bspline curve of degree {} needs at least {}.",
                                               p.points.size(), p.degree, p.degree + 1));
    if (p.kind == CurveKind::Ribbon) {
        if (p.normals.size() != count + 1)
            throw set.Error("N", "a ribbon of {} segments needs {} normals \"N\", and there are {}.", count, count + 1,
                            p.normals.size());
    } else if (!p.normals.empty()) {
        set.Warn(context.sink, "N", "\"N\" is used only for type \"ribbon\".");
        p.normals.clear();
    }
    const Float width0 = p.width0.value_or(p.width), width1 = p.width1.value_or(p.width);
    const Float splitDepth = p.splitDepth.value_or(Float(p.intSplitDepth));
    std::vector<Curves::Segment> segments(count);
    std::vector<Normal3> ends;
    for (size_t i = 0; i < count; ++i) {
        auto along = [&](size_t k) { return Float(k) / Float(count); };
        segments[i] = {SegmentOf(p.points, i, p.degree, p.basis), Lerp(along(i), width0, width1),
                       Lerp(along(i + 1), width0, width1), int(std::clamp(splitDepth, Float(0), Float(10)))};
        if (!p.normals.empty()) ends.insert(ends.end(), {p.normals[i], p.normals[i + 1]});
    }
    return One<Curves>(context, p.kind, std::move(segments), std::move(ends));
}

struct LoopSubdivisionParams {
    int levels = 3;
    std::string scheme = "loop";
    std::span<const int> indices;
    std::vector<Point3> points;
    void Describe(auto &&v) {
        // OpenSubdiv's limit is 15; 10 levels split each triangle into a million.
        v("levels", levels, Range<int>{0, 10}, "times that a triangle is split into four");
        v("indices", indices, Required(), "corner indices of the triangles");
        v("P", points, kPoints, "points");
        v("scheme", scheme, "no effect, as in stock");
    }
};

ShapeList MakeLoopSubdivision(const LoopSubdivisionParams &p, const ParamSet &set, const ShapeContext &context) {
    const std::vector<uint32_t> corners = WholeFaces(p.indices, 3, p.points.size(), set, context.sink);
    // Includes topology and coarser levels, each a quarter of the next.
    constexpr double kBytesPerTriangle = 400;
    const double triangles = double(corners.size() / 3) * std::pow(4.0, p.levels);
    RequireMemory(triangles * kBytesPerTriangle, fmt::format("{}: a mesh of {:.2g} triangles", set.What(), triangles),
                  set.LocOf("levels"));
    return One<TriangleMesh>(context, set.At("indices", [&] { return LoopSubdivide(corners, p.points, p.levels); }));
}

struct PlyMeshParams {
    std::string filename;
    Float edgeLength = 1;
    void Describe(auto &&v) {
        v("filename", filename, Required(), "PLY file");
        v("edgelength", edgeLength, kLengthRange, "maximum edge of displaced triangles");
    }
};

ShapeList MakePlyMesh(const PlyMeshParams &p, const ParamSet &set, const ShapeContext &context) {
    PlyMesh ply = set.At("filename", [&] {
        const std::string path = context.files.Resolve(p.filename);
        return ParsePly(ReadFileContents(path), path);
    });
    const auto warn = [&](const std::string &text) {
        set.Warn(context.sink, "filename", fmt::format("{}: {}", p.filename, text));
    };
    if (ply.ignoredFaces > 0)
        warn(fmt::format("ignores {} with neither 3 nor 4 corners.", CountText(ply.ignoredFaces, "face")));
    if (ply.brokenAttributes > 0)
        warn(fmt::format("normals or uv that are infinite or not a number are taken as 0: {}.", ply.brokenAttributes));
    if (ply.surplusBytes > 0)
        warn(fmt::format("has {} after its last element; the file may be damaged.",
                         CountText(ply.surplusBytes, "byte")));
    if (context.displacement) {
        try {
            const Transform place = Product({context.renderFromPlaced, context.renderFromObject});
            return One<TriangleMesh>(context, DisplaceMesh(ply, place, p.edgeLength, *context.displacement));
        } catch (const DisplacementError &e) {
            throw set.Error(e.parameter, "{}: {}", p.filename, e.Diagnostics().front().message);
        }
    }
    ShapeList shapes;
    if (!ply.triangles.indices.empty()) shapes = One<TriangleMesh>(context, std::move(ply.triangles));
    if (!ply.quads.indices.empty())
        shapes.push_back(std::move(One<BilinearMesh>(context, std::move(ply.quads)).front()));
    return shapes;
}

struct QuadricParams {
    Float radius = 1, phiMax = 360;
    void Describe(auto &&v) {
        v("radius", radius, kLengthRange, "radius");
        v("phimax", phiMax, AnyFloat("degrees"), "maximum angle around the axis");
    }
};

struct SphereParams : QuadricParams {
    std::optional<Float> zMin, zMax;
    void Describe(auto &&v) {
        QuadricParams::Describe(v);
        v("zmin", zMin, kCoordinateRange, "lower end; default: -radius");
        v("zmax", zMax, kCoordinateRange, "upper end; default: radius");
    }
};

struct DiskParams : QuadricParams {
    Float height = 0, inner = 0;
    void Describe(auto &&v) {
        v("height", height, kCoordinateRange, "z of the disk");
        QuadricParams::Describe(v);
        v("innerradius", inner, kCoordinateRange, "radius of the hole");
    }
};

struct CylinderParams : QuadricParams {
    Float zMin = -1, zMax = 1;
    void Describe(auto &&v) {
        QuadricParams::Describe(v);
        v("zmin", zMin, kCoordinateRange, "lower end");
        v("zmax", zMax, kCoordinateRange, "upper end");
    }
};

/// Requires shapes within kCoordinateRange and, where traced in object space, a non-singular transform.
template <class P, class F>
void AddShape(ShapeTable &table, const char *name, const char *summary, bool isTracedInObjectSpace, F make,
              ShapeTraits traits = {}) {
    const auto makeChecked = [make, isTracedInObjectSpace](P p, const ParamSet &set, const ShapeContext &context) {
        if (isTracedInObjectSpace && context.renderFromObject.IsSingular())
            throw set.Error("", "the current transformation flattens the shape (its matrix is singular).");
        ShapeList shapes = make(std::move(p), set, context);
        for (const auto &shape : shapes) RequireReach(set.What(), *shape, set.Loc());
        return shapes;
    };
    table.Add<P>(name, summary, makeChecked, traits);
}

}  // namespace

const ShapeTable &Shapes() {
    static const ShapeTable table("Shape", [](ShapeTable &t) {
        AddShape<TriangleMeshParams>(t, "trianglemesh", "", false,
                                     [](TriangleMeshParams p, const ParamSet &set, auto &c) {
                                         return One<TriangleMesh>(c, p.Finish(set, c.sink, 3));
                                     });
        AddShape<BilinearMeshParams>(t, "bilinearmesh", "", false, MakeBilinearMesh);
        AddShape<CurveParams>(t, "curve",
                              "no light, as in stock: `Shape \"curve\" cannot be an area light (nor can it in stock "
                              "pbrt-v4).`",
                              true, MakeCurve);
        AddShape<LoopSubdivisionParams>(t, "loopsubdiv", "limit surface by OpenSubdiv", false, MakeLoopSubdivision);
        AddShape<PlyMeshParams>(
            t, "plymesh",
            "displacement **differs** ([departures](#departures)); more than 33 million triangles of one displaced "
            "mesh are an error",
            false, MakePlyMesh, {.isDisplaceable = true});
        AddShape<SphereParams>(t, "sphere", "as lights **differs** when scaled: [area lights](#area-lights)", true,
                               [](const SphereParams &p, const ParamSet &, auto &c) {
                                   ShapeList shapes;
                                   shapes.push_back(std::make_unique<Sphere>(
                                       p.radius, p.zMin.value_or(-p.radius), p.zMax.value_or(p.radius), p.phiMax,
                                       c.renderFromObject, c.reverseOrientation, c.opaque));
                                   return shapes;
                               });
        AddShape<DiskParams>(t, "disk", "as sphere", true, [](const DiskParams &p, const ParamSet &, auto &c) {
            return One<Disk>(c, p.height, p.radius, p.inner, p.phiMax);
        });
        AddShape<CylinderParams>(t, "cylinder", "as sphere", true,
                                 [](const CylinderParams &p, const ParamSet &, auto &c) {
                                     return One<Cylinder>(c, p.radius, p.zMin, p.zMax, p.phiMax);
                                 });
    });
    return table;
}

}  // namespace pbrt
