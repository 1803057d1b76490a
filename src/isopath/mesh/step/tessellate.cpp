#include "isopath/mesh/step/tessellate.h"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IGESControl_Reader.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_ProgressIndicator.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "isopath/core/error.h"

namespace isopath {
namespace {

/// OpenCASCADE prints through one messenger of the whole process; while this lives, it is silent.
class SilentMessenger {
 public:
  SilentMessenger() : printers_(Message::DefaultMessenger()->Printers()) {
    Message::DefaultMessenger()->ChangePrinters().Clear();
  }
  SilentMessenger(const SilentMessenger&) = delete;
  SilentMessenger& operator=(const SilentMessenger&) = delete;
  ~SilentMessenger() { Message::DefaultMessenger()->ChangePrinters() = printers_; }

 private:
  Message_SequenceOfPrinters printers_;
};

/// Hands OpenCASCADE's progress on, and the wish to stop back.
class ProgressBridge : public Message_ProgressIndicator {
 public:
  explicit ProgressBridge(Progress& progress) : progress_(progress) {}

  Standard_Boolean UserBreak() override { return progress_.cancelled(); }
  void Show(const Message_ProgressScope&, const Standard_Boolean) override { progress_.at(GetPosition()); }

 private:
  Progress& progress_;
};

[[noreturn]] void reject(std::string what) {
  throw Error(ErrorCode::bad_input, std::move(what), {.advice = "export the part again from the CAD system"});
}

TopoDS_Shape read_shape(const std::string& file, bool iges, Progress& progress) {
  std::unique_ptr<XSControl_Reader> reader;
  if (iges) {
    reader = std::make_unique<IGESControl_Reader>();
  } else {
    reader = std::make_unique<STEPControl_Reader>();
  }
  if (reader->ReadFile(file.c_str()) != IFSelect_RetDone) {
    reject(iges ? "the file is not valid IGES" : "the file is not valid STEP");
  }
  const Handle(ProgressBridge) bridge = new ProgressBridge(progress);
  reader->TransferRoots(bridge->Start());
  progress.checkpoint();
  return reader->OneShape();
}

/// Sews the faces together when some of them do not share their edges.
TopoDS_Shape sewn(const TopoDS_Shape& shape, double tolerance) {
  TopTools_IndexedDataMapOfShapeListOfShape faces_of_edge;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces_of_edge);
  bool loose = false;
  for (int i = 1; i <= faces_of_edge.Extent() && !loose; ++i) {
    const TopoDS_Edge edge = TopoDS::Edge(faces_of_edge.FindKey(i));
    loose = faces_of_edge(i).Extent() == 1 && !BRep_Tool::Degenerated(edge);
  }
  if (!loose) return shape;
  BRepBuilderAPI_Sewing sewing(tolerance);
  sewing.Add(shape);
  sewing.Perform();
  return sewing.SewedShape().IsNull() ? shape : sewing.SewedShape();
}

/// Collects the triangles of the faces. Nodes of different faces become one vertex where they stand at the same place
/// of a common edge; this follows the topology of the model and needs no tolerance.
class Welder {
 public:
  void add(const TopoDS_Face& face) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
    if (mesh.IsNull()) return;
    const gp_Trsf transformation = location.Transformation();
    const auto first = static_cast<Index>(soup_.positions.size());
    for (int i = 1; i <= mesh->NbNodes(); ++i) {
      const gp_Pnt p = mesh->Node(i).Transformed(transformation);
      soup_.positions.emplace_back(p.X(), p.Y(), p.Z());
      parent_.push_back(first + i - 1);
    }
    const bool flip = (face.Orientation() == TopAbs_REVERSED) != transformation.IsNegative();
    for (int i = 1; i <= mesh->NbTriangles(); ++i) {
      int a = 0;
      int b = 0;
      int c = 0;
      mesh->Triangle(i).Get(a, b, c);
      if (flip) std::swap(b, c);
      soup_.triangles.push_back({first + a - 1, first + b - 1, first + c - 1});
    }
    for (TopExp_Explorer edges(face, TopAbs_EDGE); edges.More(); edges.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(edges.Current());
      const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, mesh, location);
      if (!polygon.IsNull()) join(edge, *polygon, first);
    }
  }

  TriangleSoup take() {
    TriangleSoup out;
    std::vector<Index> number(parent_.size(), no_index);
    for (Triangle t : soup_.triangles) {
      for (Index& v : t) v = root(v);
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      for (Index& v : t) {
        if (number[v] == no_index) {
          number[v] = static_cast<Index>(out.positions.size());
          out.positions.push_back(soup_.positions[v]);
        }
        v = number[v];
      }
      out.triangles.push_back(t);
    }
    return out;
  }

 private:
  /// Joins the nodes of an edge with those that other faces have on it, and its ends with those of other edges.
  void join(const TopoDS_Edge& edge, const Poly_PolygonOnTriangulation& polygon, Index first) {
    std::vector<Index> nodes;
    for (int i = 1; i <= polygon.NbNodes(); ++i) nodes.push_back(first + polygon.Node(i) - 1);
    const std::size_t slot = static_cast<std::size_t>(edges_.Add(edge)) - 1;
    if (slot == nodes_of_edge_.size()) nodes_of_edge_.push_back(nodes);
    const std::vector<Index>& known = nodes_of_edge_[slot];
    if (known.size() == nodes.size()) {
      for (std::size_t i = 0; i < nodes.size(); ++i) join(known[i], nodes[i]);
    }
    join_vertex(TopExp::FirstVertex(edge), nodes.front());
    join_vertex(TopExp::LastVertex(edge), nodes.back());
  }
  void join_vertex(const TopoDS_Vertex& vertex, Index node) {
    if (vertex.IsNull()) return;
    const std::size_t slot = static_cast<std::size_t>(vertices_.Add(vertex)) - 1;
    if (slot == node_of_vertex_.size()) node_of_vertex_.push_back(node);
    join(node_of_vertex_[slot], node);
  }
  void join(Index a, Index b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  Index root(Index v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }

  TriangleSoup soup_;
  std::vector<Index> parent_;  ///< disjoint sets of nodes, the lowest node stands for its set
  TopTools_IndexedMapOfShape edges_;
  TopTools_IndexedMapOfShape vertices_;
  std::vector<std::vector<Index>> nodes_of_edge_;
  std::vector<Index> node_of_vertex_;
};

TriangleSoup tessellate(const TopoDS_Shape& whole, const StepOptions& options, Progress& progress) {
  if (whole.IsNull()) reject("the file holds no shape");
  double chord = options.chordal_tolerance;
  if (chord == 0) {
    Bnd_Box box;
    BRepBndLib::Add(whole, box, false);
    if (box.IsVoid()) reject("the file holds no faces");
    chord = 1e-3 * std::sqrt(box.SquareExtent());
  }
  const TopoDS_Shape shape = sewn(whole, 0.1 * chord);
  progress.checkpoint();
  const Handle(ProgressBridge) bridge = new ProgressBridge(progress);
  IMeshTools_Parameters parameters;
  parameters.Deflection = chord;
  parameters.Angle = options.angular_tolerance;
  BRepMesh_IncrementalMesh mesher(shape, parameters, bridge->Start());
  progress.checkpoint();

  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  Welder welder;
  for (int i = 1; i <= faces.Extent(); ++i) {
    progress.checkpoint();
    welder.add(TopoDS::Face(faces(i)));
  }
  TriangleSoup soup = welder.take();
  if (soup.triangles.empty()) reject("the file holds no faces");
  return soup;
}

}  // namespace

TriangleSoup tessellate_step(const std::filesystem::path& path, bool iges, const StepOptions& options,
                             Progress& progress) {
  // OpenCASCADE keeps its messenger and its exchange parameters in variables of the whole process.
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  const SilentMessenger silent;
  try {
    progress.stage("reading CAD faces");
    const TopoDS_Shape shape = read_shape(path.string(), iges, progress);
    progress.stage("cutting CAD faces into triangles");
    return tessellate(shape, options, progress);
  } catch (const Standard_Failure& failure) {
    throw Error(ErrorCode::bad_input, "OpenCASCADE cannot make sense of the file",
                {.file = path.string(),
                 .value = failure.GetMessageString(),
                 .advice = "export the part again from the CAD system"});
  } catch (const Error& error) {
    throw error.in_file(path.string());
  }
}

}  // namespace isopath
