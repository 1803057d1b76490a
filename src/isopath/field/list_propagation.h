#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/core/team.h"
#include "isopath/field/edge_envelope.h"
#include "isopath/field/edge_windows.h"
#include "isopath/field/front_order.h"
#include "isopath/field/intrinsic_geometry.h"
#include "isopath/field/large_pages.h"
#include "isopath/field/list_step.h"
#include "isopath/field/list_trim.h"
#include "isopath/field/source_fronts.h"
#include "isopath/field/vertex_fan.h"
#include "isopath/field/window_list.h"
#include "isopath/mesh/local_numbering.h"

namespace isopath {

/// Exact distances, by whole lists of windows that cross triangles (Qin et al. 2016), in rounds.
///
/// Lists and vertices wait in buckets by their least distance. A round takes all of the nearest bucket: vertices hand
/// their distance on along their edges and send out fans, lists are trimmed and cross their triangle, all at the same
/// time: while they do, no distance changes. What they found for vertices is taken over afterwards, and of two ways as
/// short as each other the one from the half-edge with the lower number, then from the lower root; so the result does
/// not depend on the number of threads. A list that is put down may belong into the same bucket again, and a vertex may
/// improve after it sent its fan (label correcting): it then sends another. Nothing is dropped but rays that are longer
/// than a way that is known; the shortest ways stay.
///
/// Inside, vertices and half-edges have the numbers of a LocalNumbering; sources come in and results go out by those of
/// the mesh.
class ListPropagation {
 public:
  /// `retain` keeps the windows of every edge.
  ListPropagation(const TriangleMesh& mesh, const IntrinsicGeometry& geometry, bool retain);
  ListPropagation(const ListPropagation&) = delete;
  ListPropagation& operator=(const ListPropagation&) = delete;

  /// Lays out the sources; once, before anything else.
  void start(const SourceFronts& fronts);
  /// About how far the farthest vertex is along edges, of those within the stop distance; between start() and run().
  double reach_along_edges(double stop_distance, Progress& progress) const;
  /// Lets windows be merged; before run().
  void merge_within(const MergeLimits& limits);
  void run(double stop_distance, Progress& progress);

  /// The lower envelope on every edge of all that was propagated; once, after run().
  EdgeWindows take_windows(Progress& progress);

  std::vector<double> vertex_distances() const;
  std::vector<Index> vertex_roots() const;
  /// Per half-edge.
  std::vector<FanArc> fans() const;
  std::size_t propagated() const;
  /// Memory of the windows behind the front, in bytes.
  std::size_t window_bytes() const;

 private:
  static constexpr Index not_waiting = std::numeric_limits<Index>::max();
  static constexpr double full_turn = 2 * std::numbers::pi;

  /// How the shortest way reaches a vertex: the way back has the direction `back`, of any length, in the frame of an
  /// outgoing half-edge.
  struct Arrival {
    Index halfedge;
    float slack;   ///< angle by which rounding may turn `back`
    double error;  ///< most that the distance is off, by merging windows
    Vec2 back;
  };
  /// All that is needed of a half-edge, on one line of the cache.
  struct alignas(64) Site {
    WindowBlock* waiting[3];  ///< by Feeder
    double length;
    Vec2 apex;
    Index twin;
    Index tail;
    Index bucket;
    Index memory;  ///< number of its memory, counted from 1; or less the number of lists that crossed
  };
  /// And of a vertex.
  struct alignas(64) VertexState {
    double total_angle;
    Arrival arrival;
    Index root;
    Index bucket;
    bool may_bend;
    bool locked;  ///< while one thread of several takes over a way
  };
  struct Offer {
    Index vertex;
    Index root;
    double distance;
    Arrival arrival;
  };
  /// A part of a vertex's fan, in one face: between two directions measured from the outgoing half-edge, as
  /// fan_interval() takes them.
  struct Fan {
    Index vertex;
    Index outgoing;
    double low;
    double high;
  };
  /// A list that crossed, with its windows behind it in memory.
  struct KeptList {
    KeptList* next;
    std::size_t size;
  };
  /// One list on its way through a triangle.
  struct Crossing {
    Index halfedge = no_index;
    Index depth = 0;  ///< see WindowBlock
    WindowBlock* lists[3] = {nullptr, nullptr, nullptr};
  };
  /// What a thread works with.
  struct alignas(64) Workshop {
    explicit Workshop(bool is_tagged) : blocks(is_tagged), tagged(is_tagged) {}

    WindowArrays scratch(int which, std::size_t n);
    KeptList* keep(const WindowArrays& windows, std::size_t n);
    /// Room in `sides` for a list of n windows.
    void make_sides(std::size_t n);

    WindowBlocks blocks;
    bool tagged;
    // What other threads look at in a round, apart from what changes all the time.
    alignas(64) std::vector<FrontOrder::Noted> active;  ///< vertices of this round
    std::vector<Crossing> crossings;                    ///< lists of this round
    alignas(64) FrontOrder::Notes halfedges;            ///< where lists wait
    FrontOrder::Notes vertices;                         ///< that wait
    std::vector<Index> crowded;                         ///< half-edges that shall begin to remember
    alignas(64) std::vector<Offer> offers;  ///< to neighbours, and to the corners of triangles that were crossed
    std::vector<Fan> fans;                  ///< of some vertices
    std::vector<FrontOrder::Noted> sorted;
    std::size_t propagated = 0;
    EdgeEnvelope envelope;
    std::vector<WindowBlock*> waiting;
    LargeVector<double> arrays[4];  ///< of scratch(): two for gather(), one for news(), one for merged()
    LargeVector<double> sides[2];
    WindowMemory kept;
  };
  /// Lists from three sides wait at a half-edge: from two edges of the face before it, and from its third corner.
  enum Feeder { from_next = 0, from_previous = 1, from_corner = 2 };

  /// Lists of the fronts that leave the sources' faces.
  void put_down_fronts(const std::vector<SourceFronts::Front>& fronts, Workshop& workshop);
  void push_halfedge(Index halfedge, double least, float along, Workshop& workshop);
  /// Takes a way over if it is shorter; a vertex that thereby begins to wait is noted in the workshop.
  void offer_vertex(const Offer& offer, Workshop& workshop);
  /// The same, for several threads at a time.
  void offer_vertex_locked(const Offer& offer, Workshop& workshop);
  /// Takes over what a member found for vertices.
  void take_over_offers(Workshop& workshop, bool among_others);
  /// Where lists wait that leave a face by this half-edge: at its twin; on the boundary at itself, in the twin's frame,
  /// when windows are retained.
  Index waiting_place(Index leaving) const {
    const Index twin = sites_[leaving].twin;
    return twin == no_index && retain_ ? leaving : twin;
  }

  /// Angle by which the direction to a point of the plane, at this distance, may be off.
  float slack_at(double distance) const { return static_cast<float>(std::min(rounding_ / distance, full_turn)); }

  /// True where shortest ways may bend at a vertex; or where nobody can tell, since rounding turns the rays that come
  /// from so near: it then sends a fan into the slit between those that pass left and right of it.
  bool may_bend(Index vertex) const;
  void relax_edges(Index vertex, Workshop& workshop) const;
  void find_fans(Index vertex, Workshop& workshop);
  void send_fan(const Fan& fan, Workshop& workshop);
  void put_down(Index halfedge, Feeder feeder, WindowBlock* block);

  void fetch_around(Index vertex) const;
  void fetch(const Crossing& crossing, const WindowBlocks& blocks) const;
  /// The waiting lists as one, sorted; in one of their blocks when there is only one, otherwise in a scratch.
  WindowArrays gather(Crossing& crossing, Workshop& workshop, std::size_t& n, WindowBlock*& owner) const;
  void cross(Crossing& crossing, Workshop& workshop);
  /// The way to the apex of a list's triangle, from where the half-edge before `previous` ends.
  Arrival arrival_at_apex(const WindowArrays& windows, const ApexReach& apex, const StepGeometry& triangle,
                          Index previous) const;
  /// The lower envelope of a list, with neighbours merged as the limits allow: in place, or in a scratch where it has
  /// more windows. Windows that are longer by less than the accuracy are not cut otherwise.
  WindowArrays merged(const WindowArrays& windows, std::size_t& n, double length, Workshop& workshop) const;
  /// Drops and cuts windows that are beaten by known distances, and by each other where `several` lists met: one that
  /// comes alone was trimmed in the triangles before, and has little left to lose.
  void trim(WindowArrays& windows, std::size_t& n, Index halfedge, bool several, Workshop& workshop);
  /// What a list still adds to all that crossed the same half-edge before.
  WindowArrays news(const WindowArrays& windows, std::size_t& n, Index halfedge, Workshop& workshop);

  /// Ends the waiting of a half-edge or vertex that was noted for this bucket; false where it waits here no more. It
  /// may have been called from a nearer bucket since it was noted, and be noted twice in this one.
  bool stops_waiting(Index& bucket) const;
  /// The lists that wait at a half-edge for this bucket; false when they were taken before.
  bool take(Index halfedge, Crossing& crossing, Workshop& workshop);
  /// What was noted for this bucket, in order.
  void collect(FrontOrder::Notes& notes, std::vector<FrontOrder::Noted>& sorted) const;
  using Notes = FrontOrder::Notes Workshop::*;
  std::size_t n_waiting(Notes notes, const Workshop& workshop) const;
  /// Calls work(workshop, among_others) for each, at the same time where there is much to do: offers to take over, and
  /// what is noted.
  template <class Work>
  void each_workshop(Team& team, Notes notes, const Work& work);
  /// Calls work(items, first, past, member) for parts of the items of all workshops, at the same time.
  template <class Item, class Work>
  void share(Team& team, std::vector<Item> Workshop::*items, std::size_t at_a_time, const Work& work);
  /// Vertices that wait hand on their distance; false when none does.
  bool run_vertices(Team& team);
  void run_lists(Team& team);
  void remember_crowded();
  /// Where threads that share the front meet; one thread alone asks for no order.
  float along(Index vertex) const { return is_shared_ ? order_.along(positions_[vertex]) : 0; }
  /// Turns the axis of the order to the present front.
  void turn_order();
  /// Where what waits is on the axis of the order.
  void place_notes();

  void fetch_kept(Index halfedge) const;
  /// The envelope on an edge, by its canonical half-edge.
  void add_kept(EdgeEnvelope& envelope, Index halfedge, Index edge, std::vector<Window>& all) const;
  double snap_width(double edge_length) const;

  const TriangleMesh& mesh_;
  const IntrinsicGeometry& geometry_;
  LocalNumbering numbering_;  ///< of vertices and half-edges below; of edges it is the mesh's
  bool retain_;
  MergeLimits limits_;
  LargeVector<Site> sites_;
  VertexRings rings_;
  LargeVector<VertexState> states_;
  std::vector<double> distances_;  ///< per vertex: apart, as lists ask for nothing else
  std::vector<Index> source_at_;   ///< per vertex: index into source_arcs_, or none
  std::vector<std::vector<BlockedArc>> source_arcs_;
  std::vector<FanArc> fans_;                            ///< per half-edge, when windows are retained
  std::vector<KeptList*> kept_;                         ///< per half-edge, when windows are retained
  std::vector<std::pair<Index, Window>> edge_sources_;  ///< by edge: sources on the edge itself
  std::vector<EdgeEnvelope> memories_;                  ///< of half-edges that are crossed again and again
  std::deque<Workshop> workshops_;                      ///< by member of the team
  std::vector<Vec3> own_positions_;                     ///< of vertices, where they are numbered anew
  const Vec3* positions_;
  double bucket_width_ = 1;
  double rounding_ = 0;  ///< of coordinates and distances
  double margin_ = 0;
  bool is_shared_ = false;
  FrontOrder order_;
  Index bucket_ = 0;
};

}  // namespace isopath
