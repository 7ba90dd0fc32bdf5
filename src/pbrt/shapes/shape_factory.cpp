#include "pbrt/shapes/shape_factory.h"

#include "pbrt/core/memory.h"
#include "pbrt/images/image.h"
#include "pbrt/shapes/bilinear_mesh.h"
#include "pbrt/shapes/curves.h"
#include "pbrt/shapes/cylinder.h"
#include "pbrt/shapes/disk.h"
#include "pbrt/shapes/extent.h"
#include "pbrt/shapes/loop_subdivision.h"
#include "pbrt/shapes/ply.h"
#include "pbrt/shapes/sphere.h"
#include "pbrt/shapes/triangle_mesh.h"

namespace pbrt {

namespace {

using Shapes = std::vector<std::unique_ptr<Shape>>;

/// Everything a maker needs.
struct Request {
    const ParamSet &params;
    const Transform &renderFromObject;
    bool reverseOrientation;
    const FileResolver &files;
    DiagnosticSink &sink;
    const Displacement *displacement;  ///< null: none
    bool opaque;
};

template <class Mesh>
Shapes One(const Request &r, MeshData data) {
    Shapes shapes;
    shapes.push_back(std::make_unique<Mesh>(std::move(data), r.renderFromObject, r.reverseOrientation));
    return shapes;
}

std::vector<Vector3> Triples(std::span<const Float> v) {
    std::vector<Vector3> out(v.size() / 3);
    for (size_t i = 0; i < out.size(); ++i) out[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
    return out;
}

std::vector<Point2> Pairs(std::span<const Float> v) {
    std::vector<Point2> out(v.size() / 2);
    for (size_t i = 0; i < out.size(); ++i) out[i] = {v[2 * i], v[2 * i + 1]};
    return out;
}

/// Stock pbrt-v4 reports arrays of the wrong length and goes on without them.
template <class T>
void DiscardUnlessPer(const Request &r, std::vector<T> &values, size_t expected, const char *name, const char *what) {
    if (values.empty() || values.size() == expected) return;
    r.sink.Warning(r.params.LocOf(name), fmt::format("{}: \"{}\" has {} entries for {} {}; it is discarded.",
                                                     r.params.What(), name, values.size(), expected, what));
    values.clear();
}

/// What trianglemesh and bilinearmesh share; `corners` per face.
MeshData ReadMesh(const Request &r, size_t corners, bool readTangents) {
    const ParamSet &params = r.params;
    MeshData mesh;
    std::span<const int> indices = params.GetInts("indices");
    mesh.p = Triples(params.GetFloats("P", ParamType::Point3));
    mesh.n = Triples(params.GetFloats("N", ParamType::Normal));
    if (readTangents) mesh.s = Triples(params.GetFloats("S", ParamType::Vector3));
    mesh.uv = Pairs(params.GetFloats("uv", ParamType::Point2));
    std::span<const int> faceIndices = params.GetInts("faceIndices");
    mesh.faceIndices.assign(faceIndices.begin(), faceIndices.end());

    if (mesh.p.empty()) throw UserError(fmt::format("{}: \"point3 P\" is missing.", params.What()), params.Loc());
    if (indices.empty()) {
        if (mesh.p.size() != corners)
            throw UserError(fmt::format("{}: \"integer indices\" is missing; it may be left out only for exactly {} "
                                        "points, and there are {}.",
                                        params.What(), corners, mesh.p.size()),
                            params.Loc());
        for (size_t i = 0; i < corners; ++i) mesh.indices.push_back(static_cast<uint32_t>(i));
    }
    size_t excess = indices.size() % corners;
    if (excess != 0)
        r.sink.Warning(
            params.LocOf("indices"),
            fmt::format("{}: the number of \"indices\" ({}) is not a multiple of {}; the last {} are dropped.",
                        params.What(), indices.size(), corners, excess));
    for (int i : indices.first(indices.size() - excess)) {
        if (i < 0 || static_cast<size_t>(i) >= mesh.p.size())
            throw UserError(
                fmt::format("{}: index {} is out of range; there are {} points.", params.What(), i, mesh.p.size()),
                params.LocOf("indices"));
        mesh.indices.push_back(static_cast<uint32_t>(i));
    }
    if (mesh.indices.empty())
        throw UserError(fmt::format("{}: no complete face is left.", params.What()), params.LocOf("indices"));
    DiscardUnlessPer(r, mesh.n, mesh.p.size(), "N", "points");
    DiscardUnlessPer(r, mesh.s, mesh.p.size(), "S", "points");
    DiscardUnlessPer(r, mesh.uv, mesh.p.size(), "uv", "points");
    DiscardUnlessPer(r, mesh.faceIndices, mesh.indices.size() / corners, "faceIndices", "faces");
    return mesh;
}

Shapes MakeTriangleMesh(const Request &r) { return One<TriangleMesh>(r, ReadMesh(r, 3, true)); }

/// Where an image over (u, v), v upwards, is bright; null, with a warning, if it is black. A cell gets the mean of what
/// bilinear look-ups inside it give, so that nothing that shines has density 0.
std::shared_ptr<const PiecewiseConstant2D> EmissionDensity(const Request &r, const std::string &filename) {
    const Image image = ReadImage(r.files.Resolve(filename)).image;
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
    if (sum > 0) {
        // A hundredth goes everywhere: the light may shine where this image is black.
        const Float everywhere = sum / static_cast<Float>(f.size()) / 100;
        for (Float &cell : f) cell += everywhere;
        return std::make_shared<PiecewiseConstant2D>(f, n.x, n.y);
    }
    r.sink.Warning(r.params.LocOf("emissionfilename"),
                   fmt::format("{}: {} is black; it is ignored.", r.params.What(), filename));
    return nullptr;
}

Shapes MakeBilinearMesh(const Request &r) {
    const std::string filename = r.params.GetString("emissionfilename", "");
    MeshData mesh = ReadMesh(r, 4, false);
    std::shared_ptr<const PiecewiseConstant2D> emission;
    if (!filename.empty() && !mesh.uv.empty()) {
        r.sink.Warning(r.params.LocOf("emissionfilename"),
                       fmt::format("{}: \"emissionfilename\" is ignored, because there are \"uv\" (as in stock).",
                                   r.params.What()));
    } else if (!filename.empty()) {
        try {
            emission = EmissionDensity(r, filename);
        } catch (const UserError &e) {
            throw UserError(fmt::format("{}: {}", r.params.What(), e.Diagnostics().front().message),
                            r.params.LocOf("emissionfilename"));
        }
    }
    Shapes shapes;
    shapes.push_back(std::make_unique<BilinearMesh>(std::move(mesh), r.renderFromObject, r.reverseOrientation,
                                                    std::move(emission)));
    return shapes;
}

/// Quadrics and curves are traced in object space, which a singular transform does not have.
void CheckInvertible(const Request &r) {
    if (r.renderFromObject.IsSingular())
        throw UserError(
            fmt::format("{}: the current transformation flattens it (its matrix is singular).", r.params.What()),
            r.params.Loc());
}

Shapes MakeCurve(const Request &r) {
    const ParamSet &params = r.params;
    auto fail = [&](const char *name, const std::string &message) -> void {
        throw UserError(fmt::format("{}: {}", params.What(), message), params.LocOf(name));
    };
    constexpr Range<Float> kWidthRange{0, kMaxCoordinate};
    Float width = params.GetFloat("width", 1, kWidthRange);
    Float width0 = params.GetFloat("width0", width, kWidthRange);
    Float width1 = params.GetFloat("width1", width, kWidthRange);
    int degree = params.GetInt("degree", 3, {2, 3});
    std::string basisName = params.GetChoice("basis", "bezier", {"bezier", "bspline"});
    std::string type = params.GetChoice("type", "flat", {"flat", "cylinder", "ribbon"});
    Float splitDepth = params.GetFloat("splitdepth", static_cast<Float>(params.GetInt("splitdepth", 3)));
    std::vector<Point3> points = Triples(params.GetFloats("P", ParamType::Point3));
    std::vector<Normal3> normals = Triples(params.GetFloats("N", ParamType::Normal));

    if (points.empty()) fail("P", "\"point3 P\" is missing.");
    CurveBasis basis = basisName == "bezier" ? CurveBasis::Bezier : CurveBasis::BSpline;
    size_t count = SegmentCount(points.size(), degree, basis);
    if (count == 0)
        fail("P", basis == CurveBasis::Bezier
                      ? fmt::format("there are {} points; a bezier curve of degree {} needs {} + {} k.", points.size(),
                                    degree, degree + 1, degree)
                      : fmt::format("there are {} points; a bspline curve of degree {} needs at least {}.",
                                    points.size(), degree, degree + 1));
    CurveKind kind = type == "flat" ? CurveKind::Flat : type == "cylinder" ? CurveKind::Cylinder : CurveKind::Ribbon;
    if (kind == CurveKind::Ribbon) {
        if (normals.size() != count + 1)
            fail("N", fmt::format("a ribbon of {} segments needs {} normals \"N\", and there are {}.", count, count + 1,
                                  normals.size()));
    } else if (!normals.empty()) {
        r.sink.Warning(params.LocOf("N"), fmt::format("{}: \"N\" is used only for type \"ribbon\".", params.What()));
        normals.clear();
    }
    std::vector<Curves::Segment> segments(count);
    std::vector<Normal3> ends;
    for (size_t i = 0; i < count; ++i) {
        auto along = [&](size_t k) { return static_cast<Float>(k) / static_cast<Float>(count); };
        segments[i] = {SegmentOf(points, i, degree, basis), Lerp(along(i), width0, width1),
                       Lerp(along(i + 1), width0, width1),
                       static_cast<int>(std::clamp(splitDepth, Float(0), Float(10)))};
        if (!normals.empty()) ends.insert(ends.end(), {normals[i], normals[i + 1]});
    }
    CheckInvertible(r);
    Shapes shapes;
    shapes.push_back(std::make_unique<Curves>(kind, std::move(segments), std::move(ends), r.renderFromObject,
                                              r.reverseOrientation));
    return shapes;
}

Shapes MakeLoopSubdivision(const Request &r) {
    const ParamSet &params = r.params;
    // OpenSubdiv's limit is 15; 10 levels make a million triangles of each.
    int levels = params.GetInt("levels", 3, {0, 10});
    params.GetString("scheme", "loop");  // stock reads it and never uses it
    std::span<const int> indices = params.GetInts("indices");
    std::vector<Point3> points = Triples(params.GetFloats("P", ParamType::Point3));
    if (points.empty()) throw UserError(fmt::format("{}: \"point3 P\" is missing.", params.What()), params.Loc());
    if (indices.empty())
        throw UserError(fmt::format("{}: \"integer indices\" is missing.", params.What()), params.Loc());
    std::vector<uint32_t> corners;
    for (int i : indices.first(indices.size() - indices.size() % 3)) {
        if (i < 0 || static_cast<size_t>(i) >= points.size())
            throw UserError(
                fmt::format("{}: index {} is out of range; there are {} points.", params.What(), i, points.size()),
                params.LocOf("indices"));
        corners.push_back(static_cast<uint32_t>(i));
    }
    if (corners.empty())
        throw UserError(fmt::format("{}: no complete face is left.", params.What()), params.LocOf("indices"));
    // The last level with its topology, and three quarters less of every level before it.
    constexpr double kBytesPerTriangle = 400;
    const double triangles = static_cast<double>(corners.size() / 3) * std::pow(4.0, levels);
    RequireMemory(triangles * kBytesPerTriangle,
                  fmt::format("{}: a mesh of {:.2g} triangles", params.What(), triangles), params.LocOf("levels"));
    try {
        return One<TriangleMesh>(r, LoopSubdivide(corners, points, levels));
    } catch (const UserError &e) {
        throw UserError(fmt::format("{}: {}", params.What(), e.Diagnostics().front().message),
                        params.LocOf("indices"));
    }
}

Shapes MakePlyMesh(const Request &r) {
    const ParamSet &params = r.params;
    std::string filename = params.GetString("filename", "");
    // Has a meaning only together with displacement.
    const Float edgeLength = params.GetFloat("edgelength", 1, kLengthRange);
    if (filename.empty())
        throw UserError(fmt::format("{}: \"string filename\" is missing.", params.What()), params.Loc());
    PlyMesh ply;
    try {
        std::string path = r.files.Resolve(filename);
        ply = ParsePly(ReadFileContents(path), path);
    } catch (const UserError &e) {
        throw UserError(fmt::format("{}: {}", params.What(), e.Diagnostics().front().message),
                        params.LocOf("filename"));
    }
    if (ply.ignoredFaces > 0)
        r.sink.Warning(params.LocOf("filename"),
                       fmt::format("{}: {}: {} faces have neither 3 nor 4 corners and are ignored.", params.What(),
                                   filename, ply.ignoredFaces));
    if (ply.brokenAttributes > 0)
        r.sink.Warning(params.LocOf("filename"),
                       fmt::format("{}: {}: {} normals or uv are infinite or not a number; they are taken as 0.",
                                   params.What(), filename, ply.brokenAttributes));
    if (r.displacement) {
        try {
            return One<TriangleMesh>(r, DisplaceMesh(ply, r.renderFromObject, edgeLength, *r.displacement));
        } catch (const DisplacementError &e) {
            throw UserError(fmt::format("{}: {}: {}", params.What(), filename, e.Diagnostics().front().message),
                            params.LocOf(e.Parameter()));
        }
    }
    Shapes shapes;
    if (!ply.triangles.indices.empty())
        shapes.push_back(
            std::make_unique<TriangleMesh>(std::move(ply.triangles), r.renderFromObject, r.reverseOrientation));
    if (!ply.quads.indices.empty())
        shapes.push_back(
            std::make_unique<BilinearMesh>(std::move(ply.quads), r.renderFromObject, r.reverseOrientation));
    return shapes;
}

Float Radius(const Request &r) { return r.params.GetFloat("radius", 1, kLengthRange); }
Float Height(const Request &r, const char *name, Float defaultValue) {
    return r.params.GetFloat(name, defaultValue, kCoordinateRange);
}

Shapes MakeSphere(const Request &r) {
    Float radius = Radius(r), zMin = Height(r, "zmin", -radius), zMax = Height(r, "zmax", radius);
    Float phiMax = r.params.GetFloat("phimax", 360);
    CheckInvertible(r);
    Shapes shapes;
    shapes.push_back(std::make_unique<Sphere>(radius, zMin, zMax, phiMax, r.renderFromObject, r.reverseOrientation,
                                              r.opaque));
    return shapes;
}

Shapes MakeDisk(const Request &r) {
    Float height = Height(r, "height", 0), radius = Radius(r), inner = Height(r, "innerradius", 0);
    Float phiMax = r.params.GetFloat("phimax", 360);
    CheckInvertible(r);
    Shapes shapes;
    shapes.push_back(std::make_unique<Disk>(height, radius, inner, phiMax, r.renderFromObject, r.reverseOrientation));
    return shapes;
}

Shapes MakeCylinder(const Request &r) {
    Float radius = Radius(r), zMin = Height(r, "zmin", -1), zMax = Height(r, "zmax", 1);
    Float phiMax = r.params.GetFloat("phimax", 360);
    CheckInvertible(r);
    Shapes shapes;
    shapes.push_back(std::make_unique<Cylinder>(radius, zMin, zMax, phiMax, r.renderFromObject, r.reverseOrientation));
    return shapes;
}

struct Maker {
    const char *type;
    Shapes (*make)(const Request &);
};
constexpr Maker kMakers[] = {
    {"bilinearmesh", MakeBilinearMesh}, {"curve", MakeCurve}, {"cylinder", MakeCylinder}, {"disk", MakeDisk},
    {"loopsubdiv", MakeLoopSubdivision},
    {"plymesh", MakePlyMesh},           {"sphere", MakeSphere},     {"trianglemesh", MakeTriangleMesh}};

}  // namespace

std::vector<std::unique_ptr<Shape>> MakeShapes(const std::string &type, const ParamSet &params,
                                               const Transform &renderFromObject, bool reverseOrientation,
                                               const FileResolver &files, DiagnosticSink &sink,
                                               const Displacement *displacement, bool opaque) {
    for (const Maker &maker : kMakers) {
        if (type != maker.type) continue;
        Shapes shapes = maker.make({params, renderFromObject, reverseOrientation, files, sink, displacement, opaque});
        for (const auto &shape : shapes) RequireReach(params.What(), *shape, params.Loc());
        return shapes;
    }
    for (const std::string &later : UnsupportedShapes())
        if (type == later) throw UserError(fmt::format("Shape \"{}\" is not supported yet.", type), params.Loc());
    std::vector<std::string> choices = SupportedShapes();
    choices.insert(choices.end(), UnsupportedShapes().begin(), UnsupportedShapes().end());
    throw UserError(fmt::format("Shape \"{}\" is unknown; {}.", type, ListChoices(type, choices)), params.Loc());
}

const std::vector<std::string> &SupportedShapes() {
    static const std::vector<std::string> kNames = [] {
        std::vector<std::string> names;
        for (const Maker &maker : kMakers) names.emplace_back(maker.type);
        return names;
    }();
    return kNames;
}

const std::vector<std::string> &UnsupportedShapes() {
    static const std::vector<std::string> kNames = {};
    return kNames;
}

}  // namespace pbrt
