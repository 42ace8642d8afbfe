/*
 * sightlines: precomputed visibility that never hides what can be seen.
 *
 * Made from the crate sightlines-capi; do not edit.
 */


#ifndef SIGHTLINES_H
#define SIGHTLINES_H

#include <stddef.h>
#include <stdint.h>

/**
 * @file
 * The C interface of sightlines.
 *
 * **What it promises.** Answers err towards visible: what an open set of lines joins is never reported hidden. Outside of every cell
 * nothing is known, so draw everything; functions that answer for a point or a view return everything there.
 *
 * **Statuses.** Functions return SL_OK or the reason why nothing was done; sl_last_error() has it in words, for each thread. Null
 * pointers, handles of another kind, numbers out of range and buffers that are too small are such reasons. No exception leaves the
 * library, and nothing is printed but the message of a defect of the library. A program that runs out of memory ends.
 *
 * **What cannot be checked**, and is undefined behaviour: a pointer, not null, to memory that is not there, or smaller than stated; a
 * handle that was freed, or is freed while another thread is in a call with it; input that another thread changes during the call; a
 * result that goes to memory which is also an input of the call.
 *
 * **Buffers** are the caller's. A function that fills one takes its capacity, and stores how many items there are, whether they fit
 * or not. With a null buffer of capacity 0 it only stores that, and succeeds. If there are more than fit, it returns SL_ERROR_BUFFER and
 * writes nothing to the buffer.
 *
 * **Handles.** What a function makes is freed by the caller, with the function that is named there; null may be freed. Handles do not
 * need each other: a table may be freed before its viewers, and a scene before its tables.
 *
 * **Threads.** A table never changes: any number of threads may read it at once. A viewer, a scene or a relevance takes one call at a time; another
 * one meanwhile returns SL_ERROR_BUSY and does nothing. Which thread makes a call does not matter.
 *
 * **Structures** with a field struct_size: set it to sizeof the structure before the call.
 *
 * **Units** are those of the scene, angles are in radians, coordinates are doubles. Texts are UTF-8.
 */


/**
 * The version of this header: 1,000,000 times the major, 1,000 times the minor number, and the patch.
 */
#define SL_VERSION 1000

/**
 * No cell, object, portal, group or method: a number that none of them has.
 */
#define SL_NONE UINT32_MAX

/**
 * The plain form of a table, as in files that end in `.pvs`.
 */
#define SL_FORM_PLAIN 0

/**
 * The packed form, as in files that end in `.pvz`: a fraction of the size.
 */
#define SL_FORM_PACKED 1

/**
 * A table that does not say what it was made of.
 */
#define SL_KIND_UNSPECIFIED 0

/**
 * A plan cut along its axis-parallel walls.
 */
#define SL_KIND_PLAN_KD_TREE 1

/**
 * A plan cut by a triangulation.
 */
#define SL_KIND_PLAN_TRIANGULATION 2

/**
 * A scene in space cut by a k-d tree: boxes with portals between them. What is in no cell is inside of something solid.
 */
#define SL_KIND_SCENE_KD_TREE 3

/**
 * A scene in space seen from boxes that were given or cut without portals; they may overlap, and leave gaps.
 */
#define SL_KIND_SCENE_BOXES 4

/**
 * The portal file of a Quake map; points cannot be located.
 */
#define SL_KIND_QUAKE_PORTALS 5

/**
 * A Quake map with its portals.
 */
#define SL_KIND_QUAKE_MAP 6

/**
 * All directions. Only `eye` counts.
 */
#define SL_VIEW_ALL_ROUND 0

/**
 * A picture whose height takes the angle `field_of_view`, below half a turn, and whose width is `aspect` times its height: the angle
 * of view of most engines. Tables of space only.
 */
#define SL_VIEW_PERSPECTIVE 1

/**
 * A picture whose width takes the angle `field_of_view`, at most a full turn. Tables of space only.
 */
#define SL_VIEW_PERSPECTIVE_HORIZONTAL 2

/**
 * The directions within half of `field_of_view`, at most a full turn, on both sides of `direction`; z does not count. Tables of the
 * plane only.
 */
#define SL_VIEW_PLANAR 3

/**
 * What a view-projection matrix shows: `eye` and `matrix`. Tables of space only. Either hand, and any range of depth is right: 0 to 1,
 * -1 to 1, reversed, infinite; lenses may be shifted. Only the four sides count, so what is nearer than the near plane or beyond the
 * far one is in the picture.
 */
#define SL_VIEW_MATRIX 4

/**
 * The same with the matrix transposed in memory.
 */
#define SL_VIEW_MATRIX_TRANSPOSED 5

/**
 * All that the table says the eye's cells may see, in view or not.
 */
#define SL_METHOD_CELL_TO_CELL 0

/**
 * The cells whose box is in view.
 */
#define SL_METHOD_DISJOINT_CELL 1

/**
 * Those that are reached through cells whose box is in view.
 */
#define SL_METHOD_CONNECTED_COMPONENT 2

/**
 * Those that are reached through portals that are in view.
 */
#define SL_METHOD_INCIDENT_PORTALS 3

/**
 * Those to which a line leads from the eye, through open portals, within the view. The default.
 */
#define SL_METHOD_EXACT 4

/**
 * No bound on the work of a look. The default.
 */
#define SL_STEPS_UNLIMITED UINT64_MAX

/**
 * What a frame can spare as a rule: some tens of microseconds.
 */
#define SL_STEPS_FRAME 4096

/**
 * Is told of others.
 */
#define SL_PLAYER_VIEWS 1

/**
 * Others are told of it.
 */
#define SL_PLAYER_IS_SEEN 2

/**
 * It is seen, and hides nothing: glass, leaves, fences.
 */
#define SL_OBJECT_SEE_THROUGH 1

/**
 * A door that stands shut. Tables take it to be open, so it hides nothing; `sl_viewer_close_door` shuts it. Its leaf is seen where it stands;
 * `sl_scene_set_motion` says where else it gets to.
 */
#define SL_OBJECT_DOOR 2

/**
 * Its faces are mirrors.
 */
#define SL_OBJECT_MIRROR 4

/**
 * Engines draw the fronts of its triangles only, counter-clockwise: they are seen from there, and hide from there; those of closed objects hide
 * from both sides.
 */
#define SL_OBJECT_SINGLE_SIDED 8

/**
 * It moves, and may be anywhere, unless `sl_scene_set_motion` says where it stays; it hides nothing.
 */
#define SL_OBJECT_MOVING 16

/**
 * Chosen by the scene, as the program `sightlines` does: those of a k-d tree where nearly all walls are perpendicular to an axis, else
 * cells at the height of eyes above floors, or boxes cut where views differ if no file says what is up.
 */
#define SL_CELLS_CHOSEN 0

/**
 * Those of a k-d tree along the walls, with portals.
 */
#define SL_CELLS_KD_TREE 1

/**
 * `place_count` boxes, cut where rays show that views differ; without portals.
 */
#define SL_CELLS_PLACES 2

/**
 * A grid of `grid` boxes in the view region; without portals.
 */
#define SL_CELLS_GRID 3

/**
 * The boxes at `boxes`; without portals.
 */
#define SL_CELLS_BOXES 4

/**
 * Cells above floors, as high as eyes are; without portals. Viewers elsewhere see everything.
 */
#define SL_CELLS_EYE_LEVEL 5

/**
 * What follows the bodies of a game from tick to tick: who may see whom before news of it can arrive. One call at a time.
 */
typedef struct sl_relevance sl_relevance;

/**
 * A scene that is being put together. One call at a time.
 */
typedef struct sl_scene sl_scene;

/**
 * A visibility table: which cells and objects of a scene can be seen from which cells. It never changes, and any number of threads may
 * read it at once.
 */
typedef struct sl_table sl_table;

/**
 * What follows one eye through a table: the data of the cells that it was in lately, the doors that are closed for it, and its last
 * answer. One call at a time; take one for each thread that looks.
 */
typedef struct sl_viewer sl_viewer;

/**
 * What became of a call: `SL_OK`, or the reason why nothing was done. See `sl_last_error` for the reason in words.
 */
typedef int32_t sl_status;

/**
 * A box along the axes, in scene units. In a table of the plane z is 0.
 */
typedef struct sl_box {
    /**
     * The lower corner.
     */
    double min[3];
    /**
     * The upper corner.
     */
    double max[3];
} sl_box;

/**
 * What a table is about: filled by `sl_table_get_info`. Set `struct_size` to `sizeof(sl_table_info)` before.
 */
typedef struct sl_table_info {
    /**
     * The size of this structure, in bytes.
     */
    size_t struct_size;
    /**
     * 2 for a plane, 3 for space.
     */
    uint32_t dimension;
    /**
     * What was cut into cells, and how: `SL_KIND_…`.
     */
    uint32_t kind;
    /**
     * Number of cells; cells are numbered from 0.
     */
    uint32_t cell_count;
    /**
     * Number of objects; objects are numbered from 0, in the order of the scene.
     */
    uint32_t object_count;
    /**
     * Number of portals; portals are numbered from 0.
     */
    uint32_t portal_count;
    /**
     * Number of doors; doors are numbered from 0.
     */
    uint32_t door_count;
    /**
     * Number of parts of mirrors.
     */
    uint32_t mirror_part_count;
    /**
     * The axis that points up, 0 to 2; `SL_NONE` if it is not known.
     */
    uint32_t up_axis;
    /**
     * 1 if cells have names.
     */
    uint32_t has_cell_names;
    /**
     * 1 if it is known where objects are in the file that the table was made of.
     */
    uint32_t has_sources;
    /**
     * 1 if points can be located.
     */
    uint32_t has_places;
    /**
     * 1 if there may be air outside of every cell, within the box around them.
     */
    uint32_t leaves_gaps;
    /**
     * 1 if nothing is promised for eyes inside of solid matter.
     */
    uint32_t only_in_air;
    /**
     * 1 if the table stands along axes of its own, `frame_axes`. Points and views of queries are those of the scene all the same; only
     * boxes and corners that are read out of the table are along these axes.
     */
    uint32_t has_frame;
    /**
     * Three unit vectors of the scene, one after the other; those of the scene if there is no frame.
     */
    double frame_axes[9];
    /**
     * How far coordinates may be from those of the scene, along the axes of the frame, in scene units: openings narrower than this may
     * count as closed. 0 without a frame.
     */
    double frame_gap;
    /**
     * 1 if the digests are known.
     */
    uint32_t has_digest;
    /**
     * A hash of what hides in the scene that the table was made of, little-endian.
     */
    uint8_t digest_hiding[16];
    /**
     * A hash of what is seen in that scene, little-endian.
     */
    uint8_t digest_seen[16];
    /**
     * The box around all cells, along the axes of the table; all 0 without cells.
     */
    struct sl_box bounds;
    /**
     * Of all pairs of different cells, the share that may see each other, from 0 to 1; 0 for fewer than two cells.
     */
    double mean_visible_share;
} sl_table_info;

/**
 * A cell: where a viewer can be.
 */
typedef struct sl_cell {
    /**
     * The box around it.
     */
    struct sl_box bounds;
    /**
     * The group that it belongs to, such as a sector of a Doom map; `SL_NONE` for none.
     */
    uint32_t group;
    /**
     * In a plane: the number of its corners, see `sl_table_cell_corners`; 0 if the cell is the box itself.
     */
    uint32_t corner_count;
} sl_cell;

/**
 * An object: what is seen or not.
 */
typedef struct sl_object {
    /**
     * The box around it, wherever it moves.
     */
    struct sl_box bounds;
    /**
     * The polygons that are drawn for it; 1 if it is not known.
     */
    uint32_t polygon_count;
} sl_object;

/**
 * An opening between two cells.
 */
typedef struct sl_portal {
    /**
     * The two cells.
     */
    uint32_t cells[2];
    /**
     * The number of its corners, see `sl_table_portal_corners`.
     */
    uint32_t corner_count;
} sl_portal;

/**
 * Triangles of an object that follow each other in its file. Those of a primitive that is a list of triangles are drawn by an offset of three times
 * `start` indices and a count of three times the difference.
 */
typedef struct sl_range {
    /**
     * The object.
     */
    uint32_t object;
    /**
     * The first triangle.
     */
    uint32_t start;
    /**
     * The one behind the last triangle; `SL_NONE` for all, as of objects that were not cut into parts.
     */
    uint32_t end;
} sl_range;

/**
 * An eye, and the directions that it looks at. What a kind does not use is ignored, and may be 0.
 */
typedef struct sl_view {
    /**
     * `SL_VIEW_…`.
     */
    uint32_t kind;
    /**
     * Where the eye is, in scene units; z does not count in a table of the plane.
     */
    double eye[3];
    /**
     * The middle of the view; of any length but 0.
     */
    double direction[3];
    /**
     * What is up in the picture; need not be at a right angle to the direction.
     */
    double up[3];
    /**
     * An angle in radians.
     */
    double field_of_view;
    /**
     * The width of the picture, divided by its height.
     */
    double aspect;
    /**
     * From the scene to clip space: projection times view. For `SL_VIEW_MATRIX` column by column for column vectors, as OpenGL, glm
     * and Vulkan keep it; row by row for row vectors, as DirectXMath keeps it, is the same in memory. For
     * `SL_VIEW_MATRIX_TRANSPOSED` row by row for column vectors. It has to be that of a camera at `eye`, to within single precision.
     */
    double matrix[16];
} sl_view;

/**
 * The answer to a look.
 */
typedef struct sl_answer {
    /**
     * 1 if the eye is in no cell. Nothing is known there: the answer has all cells, objects and portals, and anything may be seen in
     * mirrors.
     */
    uint32_t is_outside;
    /**
     * The method that answered, `SL_METHOD_…`: the one that was asked for, or a coarser one where that had more to do than it may;
     * `SL_NONE` outside.
     */
    uint32_t method;
    /**
     * Number of cells that are seen.
     */
    uint32_t cell_count;
    /**
     * Number of objects that are seen.
     */
    uint32_t object_count;
    /**
     * Number of views into mirrors, of which `sl_viewer_follow_mirrors` tells what is seen in them.
     */
    uint32_t mirror_view_count;
} sl_answer;

/**
 * A door: what closes portals while it is shut.
 */
typedef struct sl_door {
    /**
     * The object that is the door; `SL_NONE` for one that was given as a box.
     */
    uint32_t object;
    /**
     * Number of portals that it closes; 0 if it fills no opening, or only parts of portals.
     */
    uint32_t portal_count;
} sl_door;

/**
 * Where an object is in the glTF file that its table was made of.
 */
typedef struct sl_source {
    /**
     * The index of the node in the `nodes` of the file; `SL_NONE` if it is not known.
     */
    uint32_t node;
    /**
     * The index of the primitive in the `primitives` of the node's mesh; `SL_NONE` if it is not known.
     */
    uint32_t primitive;
} sl_source;

/**
 * What is seen by way of one mirror after another.
 */
typedef struct sl_image {
    /**
     * Number of mirrors on the way.
     */
    uint32_t mirror_count;
    /**
     * Number of cells that are seen in them.
     */
    uint32_t cell_count;
    /**
     * Number of objects that are seen in them.
     */
    uint32_t object_count;
    /**
     * 1 if that is all. If 0, there were too many views: anything may be seen by way of these mirrors, and of others after them.
     */
    uint32_t is_complete;
    /**
     * 1 if a coarser method than the viewer's answered in some of these views.
     */
    uint32_t fell_back;
} sl_image;

/**
 * How `sl_relevance_update` answers; `sl_relevance_default_options` fills it. Set `struct_size` to `sizeof(sl_relevance_options)`
 * before.
 */
typedef struct sl_relevance_options {
    /**
     * The size of this structure, in bytes.
     */
    size_t struct_size;
    /**
     * For how many seconds somebody stays shown who may no longer be seen.
     */
    double hold;
    /**
     * How far a body may move until it is placed again, in scene units along each axis: more is less work, and shows bodies sooner.
     */
    double slack;
    /**
     * Up to which distance ways through portals count from the exact place of a body, in scene units, for reaches of such ways.
     */
    double walk;
    /**
     * How many bodies are placed exactly in a tick; the others are shown sooner, never later.
     */
    uint64_t looks;
} sl_relevance_options;

/**
 * Somebody who sees and is seen, and how far they may get until the answer counts. All lengths are in scene units; in a table of the
 * plane z does not count. A box or a length that is none (NaN, negative) is somebody of whom nothing is known: everybody is told of
 * them, and they of everybody.
 */
typedef struct sl_player {
    /**
     * Where the eyes can be: where the game may put its camera now, but for `arm`.
     */
    struct sl_box eyes;
    /**
     * All that can be seen of the body, with what it carries.
     */
    struct sl_box seen;
    /**
     * How far any part of it may get: speed times (round trip + interpolation + tick).
     */
    double reach;
    /**
     * How far a camera that follows the body may be from the eyes; 0 for eyes in the head.
     */
    double arm;
    /**
     * The teams of which it is told wherever they are, as bits: bit t for team t, bit 0 for those without one.
     */
    uint64_t sees_always;
    /**
     * Its team, 1 to 63; 0 for none.
     */
    uint32_t team;
    /**
     * `SL_PLAYER_VIEWS`, `SL_PLAYER_IS_SEEN`, or both with `|`.
     */
    uint32_t flags;
} sl_player;

/**
 * What changed in a tick.
 */
typedef struct sl_changes {
    /**
     * Pairs that are shown from now on: `sl_relevance_gained`.
     */
    size_t gained_count;
    /**
     * Pairs that are no longer shown: `sl_relevance_lost`.
     */
    size_t lost_count;
    /**
     * Bodies that were placed exactly.
     */
    size_t look_count;
    /**
     * Bodies that had moved and were not, as no look was left; their answers are coarser.
     */
    size_t coarse_count;
    /**
     * Bodies of which nothing is known: outside of the cells, or without a valid box. They are shown to all.
     */
    size_t outside_count;
} sl_changes;

/**
 * How far a bake is.
 */
typedef struct sl_progress {
    /**
     * What is being done, in a word or two of English, with a zero byte at the end; valid during the call only.
     */
    const char *phase;
    /**
     * Units of this phase that are done.
     */
    uint64_t done;
    /**
     * Units of this phase.
     */
    uint64_t total;
    /**
     * The share of this phase that is done, from 0 to 1, as an estimate of time.
     */
    double share;
} sl_progress;

/**
 * Receives the progress of a bake.
 *
 * It is called from any thread, by one at a time, and may come some thousand times; never again once it has returned something else
 * than 0. It must return: an exception that leaves it, or a `longjmp` out of it, is undefined behaviour. It may call any function of
 * this library but with the scene that is being baked, which is in use.
 *
 * @param user      The pointer that was given with the callback; the library does not look at it.
 * @param progress  How far the bake is; valid during the call only.
 * @return 0 to go on; anything else cancels, as soon as what is under way is finished.
 */
typedef int32_t (*sl_progress_fn)(void *user, const struct sl_progress *progress);

/**
 * How to make a table. Set everything to 0 but `struct_size`, which is `sizeof(sl_bake_options)`: 0 is the default of every field.
 */
typedef struct sl_bake_options {
    /**
     * The size of this structure, in bytes.
     */
    size_t struct_size;
    /**
     * What decides, by the name that the program has for it: "sightlines", "auto", "both", "multifocal", "line-space", "shafts".
     * Null: "auto", which measures the scene.
     */
    const char *method;
    /**
     * Where the cells come from: `SL_CELLS_…`.
     */
    uint32_t cells;
    /**
     * How many boxes to cut, for `SL_CELLS_PLACES`; 0 for 256. A number for cells of another kind is refused, as are `grid` and `box_count`.
     */
    uint32_t place_count;
    /**
     * Number of boxes along each axis, for `SL_CELLS_GRID`.
     */
    uint32_t grid[3];
    /**
     * The most cells that may be made; 0 for 65,536.
     */
    uint32_t max_cells;
    /**
     * The boxes, for `SL_CELLS_BOXES`.
     */
    const struct sl_box *boxes;
    /**
     * Number of boxes.
     */
    size_t box_count;
    /**
     * Where viewers can be; null for everywhere within the scene.
     */
    const struct sl_box *view_region;
    /**
     * How precise coordinates are, in scene units: walls within half of this of a plane across an axis of the building, which may be
     * turned by any angle, are taken to lie in it, and openings narrower than this may count as closed. 0: what single precision explains,
     * about a millionth of the building's size, where that puts many walls into planes and all objects were added in single precision;
     * else nothing. Anything below 0 takes every coordinate as it is.
     */
    double gap;
    /**
     * Objects smaller than this in every direction hide nothing; 0 for what suits the scene, anything below 0 for none.
     */
    double detail_below;
    /**
     * 1 to keep the insides of solid things as cells, for eyes that can get into them.
     */
    uint32_t keep_solid;
    /**
     * Number of threads; 0 for one for each core, and 1024 at most. The table does not depend on it.
     */
    uint32_t threads;
    /**
     * Decide for about so many seconds; what is not decided by then counts as visible, and the table depends on the machine. 0 for no
     * limit.
     */
    double time_limit;
    /**
     * Receives progress, and may cancel; null for none.
     */
    sl_progress_fn progress;
    /**
     * Passed to it.
     */
    void *user;
    /**
     * Width of cells, at most, in scene units, for `SL_CELLS_CHOSEN`, `SL_CELLS_PLACES` and `SL_CELLS_EYE_LEVEL`; 0 for what suits the kind.
     */
    double cell_size;
    /**
     * From how far to how far above floors eyes are, in scene units, for `SL_CELLS_EYE_LEVEL`; 0 and 0 for 0 to 2.5 m.
     */
    double eye_height[2];
    /**
     * The axis that points upwards, for `SL_CELLS_EYE_LEVEL`: 1, 2 or 3 for x, y or z; 0 for what the file says, or else z.
     */
    uint64_t up;
    /**
     * Scenes: objects of more triangles than this are split into parts of at most that many, and the table lists which cells may see each part
     * (`sl_table_visible_ranges`); 0 to split none.
     */
    uint64_t parts;
    /**
     * What to bake as JSON, by the names of the options of `sightlines build` with `_` for `-`: `{"method": "multifocal", "planes": 4}`. Null: as the
     * other fields say. With it, of these only `threads`, `time_limit`, `progress` and `user` may be set.
     */
    const char *request;
} sl_bake_options;

/**
 * What a bake did. Set `struct_size` to `sizeof(sl_bake_report)` before.
 */
typedef struct sl_bake_report {
    /**
     * The size of this structure, in bytes.
     */
    size_t struct_size;
    /**
     * Number of cells.
     */
    uint64_t cell_count;
    /**
     * Pairs of different cells that see each other.
     */
    uint64_t visible_pairs;
    /**
     * Pairs that count as visible because deciding them took too much effort.
     */
    uint64_t assumed_pairs;
    /**
     * Pairs of a cell and another, or an object, that count as visible because the time was up.
     */
    uint64_t undecided_pairs;
    /**
     * Seconds that it took.
     */
    double seconds;
} sl_bake_report;

/**
 * The call did what it is for.
 */
#define SL_OK 0

/**
 * A pointer that is needed is null.
 */
#define SL_ERROR_NULL 1

/**
 * A number is out of range, a text is not UTF-8, or a pointer is not aligned for its type.
 */
#define SL_ERROR_ARGUMENT 2

/**
 * What was given is no handle of the kind that is needed.
 */
#define SL_ERROR_HANDLE 3

/**
 * The buffer is too small. Its needed size was stored, and nothing was written to it.
 */
#define SL_ERROR_BUFFER 4

/**
 * A file cannot be read or written.
 */
#define SL_ERROR_FILE 5

/**
 * Bytes are no table: damaged, truncated, of another kind, or of a newer version.
 */
#define SL_ERROR_FORMAT 6

/**
 * Geometry cannot be used: a coordinate that is no finite number or too large, an index without a vertex.
 */
#define SL_ERROR_GEOMETRY 7

/**
 * A table cannot be made of this scene with these options.
 */
#define SL_ERROR_BAKE 8

/**
 * The callback cancelled.
 */
#define SL_ERROR_CANCELLED 9

/**
 * Numbers are no view: see `sl_view`.
 */
#define SL_ERROR_VIEW 10

/**
 * Another thread is inside a call with the same handle.
 */
#define SL_ERROR_BUSY 11

/**
 * The header and the library, or the size of a structure, are of versions that do not fit together.
 */
#define SL_ERROR_VERSION 12

/**
 * There is nothing of that name or number.
 */
#define SL_ERROR_NOT_FOUND 13

/**
 * The library was built without this part.
 */
#define SL_ERROR_UNSUPPORTED 14

/**
 * A defect of the library: a panic was caught. Please report it.
 */
#define SL_ERROR_INTERNAL 15

/**
 * A defect of the library struck an earlier call that used this handle. Only freeing it does anything.
 */
#define SL_ERROR_POISONED 16

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * The version of the library.
 *
 * @return It, in the form of `SL_VERSION`.
 */
uint32_t sl_version(void);

/**
 * Whether the library can serve a program that was compiled with a header of some version. Call it once at the start, as
 * `sl_check_version(SL_VERSION)`.
 *
 * A library serves headers of the same major number that are not newer than itself; while the major number is 0, of the same
 * minor number.
 *
 * @param header_version  `SL_VERSION`, as the program's header has it.
 * @return `SL_OK`, or `SL_ERROR_VERSION`: then no other function may be relied on.
 */
sl_status sl_check_version(uint32_t header_version);

/**
 * The reason in words why the last call on this thread that failed did so, in English, for developers.
 *
 * @return A text that ends with a zero byte; empty if no call failed yet. It is valid until the next call that fails on the
 *         same thread, and until that thread ends. Calls that succeed leave it as it is. Never null.
 */
const char *sl_last_error(void);

/**
 * The name of a status, such as "SL_ERROR_BUFFER".
 *
 * @param status  What a function returned.
 * @return A text that ends with a zero byte and is always valid; "unknown status" for other numbers.
 */
const char *sl_status_name(sl_status status);

/**
 * Loads a table from a file, plain or packed. The file is read whole.
 *
 * @param path   UTF-8, with a zero byte at its end.
 * @param table  Where the handle goes; free it with `sl_table_free`. Null is stored there if the call fails.
 * @return `SL_OK`, `SL_ERROR_FILE`, or `SL_ERROR_FORMAT` for a file that is no table or damaged in any byte.
 */
sl_status sl_table_load(const char *path, struct sl_table **table);

/**
 * Reads a table from memory, plain or packed. The bytes are copied and not needed afterwards.
 *
 * @param bytes  The content of a file.
 * @param size   Number of bytes.
 * @param table  Where the handle goes; free it with `sl_table_free`. Null is stored there if the call fails.
 * @return `SL_OK`, or `SL_ERROR_FORMAT` for what is no table or damaged in any byte.
 */
sl_status sl_table_from_bytes(const uint8_t *bytes, size_t size, struct sl_table **table);

/**
 * Frees a table. Viewers made of it go on working.
 *
 * @param table  A table that no other thread is using, or null, for which nothing is done.
 */
void sl_table_free(struct sl_table *table);

/**
 * The bytes of a table, as in a file. The same table has the same bytes on every machine.
 *
 * The table is encoded in every call: ask for the size with a null buffer once, and pass a buffer of that size. O(size).
 *
 * @param form      `SL_FORM_PLAIN` or `SL_FORM_PACKED`.
 * @param buffer    Where the bytes go, or null to ask for the size.
 * @param capacity  Number of bytes that the buffer has room for; 0 if it is null.
 * @param size      Where the number of bytes goes.
 * @return `SL_OK`, `SL_ERROR_BUFFER` if the buffer is too small, or `SL_ERROR_UNSUPPORTED` for a library without packed tables.
 */
sl_status sl_table_bytes(const struct sl_table *table,
                         uint32_t form,
                         uint8_t *buffer,
                         size_t capacity,
                         size_t *size);

/**
 * Writes a table to a file, which is replaced. Written to another file beside it first, so that what was there stays whole if writing
 * fails.
 *
 * @param path  UTF-8, with a zero byte at its end.
 * @param form  `SL_FORM_PLAIN` or `SL_FORM_PACKED`.
 * @return `SL_OK`, or `SL_ERROR_FILE`.
 */
sl_status sl_table_save(const struct sl_table *table,
                        const char *path,
                        uint32_t form);

/**
 * Stores what a table is about. O(cells).
 *
 * @param info  Where it goes; its `struct_size` has to be set.
 * @return `SL_OK`, or `SL_ERROR_VERSION` if the size is not that of the library's structure.
 */
sl_status sl_table_get_info(const struct sl_table *table, struct sl_table_info *info);

/**
 * Stores a cell.
 *
 * @param cell  Its number, below `cell_count`.
 * @param out   Where it goes.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such cell.
 */
sl_status sl_table_cell(const struct sl_table *table, uint32_t cell, struct sl_cell *out);

/**
 * The corners of a cell in the plane, counter-clockwise, x and y of one after the other; none if the cell is its box.
 *
 * @param cell      Its number, below `cell_count`.
 * @param corners   Where they go, or null to ask for their number.
 * @param capacity  Number of doubles that the buffer has room for; 0 if it is null.
 * @param count     Where the number of doubles goes: twice the number of corners.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such cell, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_cell_corners(const struct sl_table *table,
                                uint32_t cell,
                                double *corners,
                                size_t capacity,
                                size_t *count);

/**
 * The name of a cell, in UTF-8; empty if the cells have none. Names may repeat.
 *
 * @param cell      Its number, below `cell_count`.
 * @param buffer    Where the name goes, with a zero byte behind it, or null to ask for its length.
 * @param capacity  Number of bytes that the buffer has room for, the zero byte included; 0 if it is null.
 * @param length    Where the length in bytes goes, without the zero byte.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such cell, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_cell_name(const struct sl_table *table,
                             uint32_t cell,
                             char *buffer,
                             size_t capacity,
                             size_t *length);

/**
 * Stores an object.
 *
 * @param object  Its number, below `object_count`.
 * @param out     Where it goes.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such object.
 */
sl_status sl_table_object(const struct sl_table *table, uint32_t object, struct sl_object *out);

/**
 * The name of an object, in UTF-8. Names may repeat, be empty, and contain zero bytes: the length counts.
 *
 * @param object    Its number, below `object_count`.
 * @param buffer    Where the name goes, with a zero byte behind it, or null to ask for its length.
 * @param capacity  Number of bytes that the buffer has room for, the zero byte included; 0 if it is null.
 * @param length    Where the length in bytes goes, without the zero byte.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such object, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_object_name(const struct sl_table *table,
                               uint32_t object,
                               char *buffer,
                               size_t capacity,
                               size_t *length);

/**
 * Finds the first object of a name. O(objects).
 *
 * @param name    UTF-8, with a zero byte at its end.
 * @param object  Where its number goes.
 * @return `SL_OK`, or `SL_ERROR_NOT_FOUND`.
 */
sl_status sl_table_find_object(const struct sl_table *table, const char *name, uint32_t *object);

/**
 * Stores a portal.
 *
 * @param portal  Its number, below `portal_count`.
 * @param out     Where it goes.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such portal.
 */
sl_status sl_table_portal(const struct sl_table *table, uint32_t portal, struct sl_portal *out);

/**
 * The corners of a portal, x, y and z of one after the other. As seen going from its first cell to its second they are the left end
 * and the right end in a plane, and counter-clockwise in space.
 *
 * @param portal    Its number, below `portal_count`.
 * @param corners   Where they go, or null to ask for their number.
 * @param capacity  Number of doubles that the buffer has room for; 0 if it is null.
 * @param count     Where the number of doubles goes: three times the number of corners.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such portal, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_portal_corners(const struct sl_table *table,
                                  uint32_t portal,
                                  double *corners,
                                  size_t capacity,
                                  size_t *count);

/**
 * The cells that contain a point, ascending: several on borders, none outside of all cells.
 *
 * Where there is none, nothing is known: draw everything. So it is for a point with a coordinate that is no finite number, and
 * for tables without places. Errs towards inside, by rounding only.
 *
 * @param point     Three numbers: x, y and z, in scene units; in a table of the plane z does not count.
 * @param cells     Where the numbers of the cells go, or null to ask for how many there are.
 * @param capacity  Number of cells that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, also where there is none, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_cells_at(const struct sl_table *table,
                            const double *point,
                            uint32_t *cells,
                            size_t capacity,
                            size_t *count);

/**
 * Whether something in one cell may be seen from somewhere in another. Symmetric. O(1).
 *
 * @param a     The number of one cell, below `cell_count`.
 * @param b     That of the other.
 * @param sees  Where 1 or 0 goes.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such cell.
 */
sl_status sl_table_sees(const struct sl_table *table, uint32_t a, uint32_t b, uint32_t *sees);

/**
 * The cells that a cell may see, itself included, ascending.
 *
 * @param cell      Its number, below `cell_count`.
 * @param cells     Where their numbers go, or null to ask for how many there are.
 * @param capacity  Number of cells that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such cell, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_visible_cells(const struct sl_table *table,
                                 uint32_t cell,
                                 uint32_t *cells,
                                 size_t capacity,
                                 size_t *count);

/**
 * The row of a cell, in place: bit `j % 64` of word `j / 64` is set if the cell may see cell `j`. Nothing is copied. O(1).
 *
 * @param cell   Its number, below `cell_count`.
 * @param words  Where a pointer to the words goes. They must not be changed, and are valid until the table is freed, the
 *               viewers made of it do not count.
 * @param count  Where the number of words goes.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such cell.
 */
sl_status sl_table_row(const struct sl_table *table,
                       uint32_t cell,
                       const uint64_t **words,
                       size_t *count);

/**
 * The objects that touch a cell, ascending.
 *
 * @param cell      Its number, below `cell_count`.
 * @param objects   Where their numbers go, or null to ask for how many there are.
 * @param capacity  Number of objects that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such cell, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_objects_in_cell(const struct sl_table *table,
                                   uint32_t cell,
                                   uint32_t *objects,
                                   size_t capacity,
                                   size_t *count);

/**
 * The objects that a cell may see, ascending.
 *
 * @param cell      Its number, below `cell_count`.
 * @param objects   Where their numbers go, or null to ask for how many there are.
 * @param capacity  Number of objects that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such cell, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_visible_objects(const struct sl_table *table,
                                   uint32_t cell,
                                   uint32_t *objects,
                                   size_t capacity,
                                   size_t *count);

/**
 * What a cell may see, by ascending object: of objects that were cut into parts the ranges of triangles, and all of the others.
 *
 * @param cell      Its number, below `cell_count`.
 * @param ranges    Where the ranges go, or null to ask for how many there are.
 * @param capacity  Number of ranges that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such cell, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_visible_ranges(const struct sl_table *table,
                                  uint32_t cell,
                                  struct sl_range *ranges,
                                  size_t capacity,
                                  size_t *count);

/**
 * The objects that a cell may see, as bits: bit `j % 64` of word `j / 64` is set for object `j`.
 *
 * @param cell      Its number, below `cell_count`.
 * @param words     Where the words go, or null to ask for how many there are.
 * @param capacity  Number of words that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes: the number of objects divided by 64, rounded up.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such cell, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_visible_object_bits(const struct sl_table *table,
                                       uint32_t cell,
                                       uint64_t *words,
                                       size_t capacity,
                                       size_t *count);

/**
 * The cells that may be seen from a point, ascending. Outside of every cell nothing is known, and these are all cells.
 *
 * @param point       Three numbers: x, y and z, in scene units; in a table of the plane z does not count.
 * @param cells       Where their numbers go, or null to ask for how many there are.
 * @param capacity    Number of cells that the buffer has room for; 0 if it is null.
 * @param count       Where their number goes.
 * @param is_outside  Where 1 goes if the point is in no cell, else 0; may be null.
 * @return `SL_OK`, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_visible_cells_at(const struct sl_table *table,
                                    const double *point,
                                    uint32_t *cells,
                                    size_t capacity,
                                    size_t *count,
                                    uint32_t *is_outside);

/**
 * The objects that may be seen from a point, ascending: what to draw there. Outside of every cell nothing is known, and these are all
 * objects.
 *
 * @param point       Three numbers: x, y and z, in scene units; in a table of the plane z does not count.
 * @param objects     Where their numbers go, or null to ask for how many there are.
 * @param capacity    Number of objects that the buffer has room for; 0 if it is null.
 * @param count       Where their number goes.
 * @param is_outside  Where 1 goes if the point is in no cell, else 0; may be null.
 * @return `SL_OK`, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_visible_objects_at(const struct sl_table *table,
                                      const double *point,
                                      uint32_t *objects,
                                      size_t capacity,
                                      size_t *count,
                                      uint32_t *is_outside);

/**
 * The cells that a box touches, ascending; none outside of all cells. For placing what moves: it may be seen from where any of
 * these cells may be seen.
 *
 * @param bounds    The box, in scene units; in a table of the plane z does not count. No coordinate may be NaN.
 * @param cells     Where the numbers of the cells go, or null to ask for how many there are.
 * @param capacity  Number of cells that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` for a NaN or a table without places, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_cells_touching(const struct sl_table *table,
                                  const struct sl_box *bounds,
                                  uint32_t *cells,
                                  size_t capacity,
                                  size_t *count);

/**
 * What may be seen from a point, by ascending object, as for `sl_table_visible_ranges`: what to draw there. Outside of every cell nothing is known,
 * and it is all of every object.
 *
 * @param point       Three numbers: x, y and z, in scene units; in a table of the plane z does not count.
 * @param ranges      Where the ranges go, or null to ask for how many there are.
 * @param capacity    Number of ranges that the buffer has room for; 0 if it is null.
 * @param count       Where their number goes.
 * @param is_outside  Where 1 goes if the point is in no cell, else 0; may be null.
 * @return `SL_OK`, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_visible_ranges_at(const struct sl_table *table,
                                     const double *point,
                                     struct sl_range *ranges,
                                     size_t capacity,
                                     size_t *count,
                                     uint32_t *is_outside);

/**
 * Makes a viewer of a table: exact within the work of a frame (`SL_STEPS_FRAME`), with all doors open.
 *
 * @param table   The table, which may be freed before the viewer.
 * @param viewer  Where the handle goes; free it with `sl_viewer_free`. Null is stored there if the call fails.
 * @return `SL_OK`.
 */
sl_status sl_viewer_new(const struct sl_table *table, struct sl_viewer **viewer);

/**
 * Frees a viewer.
 *
 * @param viewer  A viewer that no other thread is using, or null, for which nothing is done.
 */
void sl_viewer_free(struct sl_viewer *viewer);

/**
 * Chooses the method of all looks from here on, and what one look may do.
 *
 * @param method     `SL_METHOD_…`: each sees less than the one before, and costs more.
 * @param max_steps  For the exact method: about so many tests of a box against a cone of sight, counted and never timed. An answer that
 *                   would take more is exact near the eye, and that of the incident portals farther away. `SL_STEPS_FRAME`,
 *                   `SL_STEPS_UNLIMITED`, or another number.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` for a number that is no method.
 */
sl_status sl_viewer_set_method(struct sl_viewer *viewer,
                               uint32_t method,
                               uint64_t max_steps);

/**
 * Bounds the memory for the data of cells that the eye was in lately, 64 MiB at first. That of the cell that was asked for last is
 * kept in any case.
 *
 * @param bytes  The bound.
 * @return `SL_OK`.
 */
sl_status sl_viewer_set_memory(struct sl_viewer *viewer,
                               size_t bytes);

/**
 * Closes a portal for this viewer, from the next look on: nothing is seen through it. Nothing is computed anew. The methods from
 * `SL_METHOD_CONNECTED_COMPONENT` on heed it.
 *
 * @param portal  Its number, below `portal_count`.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such portal.
 */
sl_status sl_viewer_close_portal(struct sl_viewer *viewer,
                                 uint32_t portal);

/**
 * Opens a portal that was closed, unless a shut door closes it too.
 *
 * @param portal  Its number, below `portal_count`.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such portal.
 */
sl_status sl_viewer_open_portal(struct sl_viewer *viewer, uint32_t portal);

/**
 * Opens all portals and doors.
 *
 * @return `SL_OK`.
 */
sl_status sl_viewer_open_all(struct sl_viewer *viewer);

/**
 * The portals that are closed, ascending.
 *
 * @param portals   Where their numbers go, or null to ask for how many there are.
 * @param capacity  Number of portals that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, or `SL_ERROR_BUFFER`.
 */
sl_status sl_viewer_closed_portals(const struct sl_viewer *viewer, uint32_t *portals, size_t capacity, size_t *count);

/**
 * Finds what an eye sees in a view. The answer stays in the viewer until the next look; `sl_viewer_cells`, `sl_viewer_objects`
 * and `sl_viewer_portals` copy it out.
 *
 * Errs towards visible. Outside of every cell the answer is everything. The first look from a cell gathers the data of that cell,
 * which takes longer; later ones from there do not.
 *
 * @param view    Where the eye is and what it looks at.
 * @param answer  Where counts and the method go; may be null.
 * @return `SL_OK`, `SL_ERROR_VIEW` for numbers that are no view of this table, or `SL_ERROR_BUSY`. After a failure the last answer
 *         stands.
 */
sl_status sl_viewer_look(struct sl_viewer *viewer,
                         const struct sl_view *view,
                         struct sl_answer *answer);

/**
 * The cells of the last look, ascending; none before the first.
 *
 * @param cells     Where their numbers go, or null to ask for how many there are.
 * @param capacity  Number of cells that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, or `SL_ERROR_BUFFER`.
 */
sl_status sl_viewer_cells(const struct sl_viewer *viewer, uint32_t *cells, size_t capacity, size_t *count);

/**
 * The objects of the last look, ascending: what to draw. None before the first.
 *
 * @param objects   Where their numbers go, or null to ask for how many there are.
 * @param capacity  Number of objects that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, or `SL_ERROR_BUFFER`.
 */
sl_status sl_viewer_objects(const struct sl_viewer *viewer, uint32_t *objects, size_t capacity, size_t *count);

/**
 * The portals that a line of the last look may pass, ascending: open ones between two cells of the answer whose box is in view. All
 * of the table outside of every cell; none before the first look. O(portals).
 *
 * @param portals   Where their numbers go, or null to ask for how many there are.
 * @param capacity  Number of portals that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, or `SL_ERROR_BUFFER`.
 */
sl_status sl_viewer_portals(const struct sl_viewer *viewer,
                            uint32_t *portals,
                            size_t capacity,
                            size_t *count);

/**
 * Stores a door.
 *
 * @param door  Its number, below `door_count`.
 * @param out   Where it goes.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such door.
 */
sl_status sl_table_door(const struct sl_table *table, uint32_t door, struct sl_door *out);

/**
 * The name of a door, in UTF-8. Names may repeat: the two wings of a door may have one.
 *
 * @param door      Its number, below `door_count`.
 * @param buffer    Where the name goes, with a zero byte behind it, or null to ask for its length.
 * @param capacity  Number of bytes that the buffer has room for, the zero byte included; 0 if it is null.
 * @param length    Where the length in bytes goes, without the zero byte.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such door, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_door_name(const struct sl_table *table,
                             uint32_t door,
                             char *buffer,
                             size_t capacity,
                             size_t *length);

/**
 * The portals that a door closes while it is shut, ascending.
 *
 * @param door      Its number, below `door_count`.
 * @param portals   Where their numbers go, or null to ask for how many there are.
 * @param capacity  Number of portals that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such door, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_door_portals(const struct sl_table *table,
                                uint32_t door,
                                uint32_t *portals,
                                size_t capacity,
                                size_t *count);

/**
 * The doors of a name, ascending: names may repeat. O(doors).
 *
 * @param name      UTF-8, with a zero byte at its end.
 * @param doors     Where their numbers go, or null to ask for how many there are.
 * @param capacity  Number of doors that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes: 0 if there is no such door.
 * @return `SL_OK`, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_find_doors(const struct sl_table *table,
                              const char *name,
                              uint32_t *doors,
                              size_t capacity,
                              size_t *count);

/**
 * The portals that lie entirely in a closed box, ascending: those that something solid of that shape closes. What is rounded errs
 * towards not in it. O(portals).
 *
 * @param bounds    The box, in scene units; z does not count in a plane. One with a NaN contains nothing.
 * @param portals   Where their numbers go, or null to ask for how many there are.
 * @param capacity  Number of portals that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_portals_within(const struct sl_table *table,
                                  const struct sl_box *bounds,
                                  uint32_t *portals,
                                  size_t capacity,
                                  size_t *count);

/**
 * Stores where an object is in the glTF file that the table was made of.
 *
 * @param object  Its number, below `object_count`.
 * @param out     Where it goes; `SL_NONE` twice if it is not known.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such object.
 */
sl_status sl_table_object_source(const struct sl_table *table, uint32_t object, struct sl_source *out);

/**
 * The objects of a node of the glTF file that the table was made of, ascending: one for each primitive of its mesh.
 *
 * @param node      Its index in the `nodes` of the file.
 * @param objects   Where the numbers of the objects go, or null to ask for how many there are.
 * @param capacity  Number of objects that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes: 0 for a node without a mesh, and where it is not known.
 * @return `SL_OK`, or `SL_ERROR_BUFFER`.
 */
sl_status sl_table_objects_of_node(const struct sl_table *table,
                                   uint32_t node,
                                   uint32_t *objects,
                                   size_t capacity,
                                   size_t *count);

/**
 * Shuts a door for this viewer, from the next look on: nothing is seen through its portals. Shutting a shut door does nothing.
 *
 * @param door  Its number, below `door_count` of the table.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such door.
 */
sl_status sl_viewer_close_door(struct sl_viewer *viewer,
                               uint32_t door);

/**
 * Opens a door that was shut. Its portals can be passed again, unless another shut door closes them, or they were closed alone.
 *
 * @param door  Its number, below `door_count` of the table.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such door.
 */
sl_status sl_viewer_open_door(struct sl_viewer *viewer,
                              uint32_t door);

/**
 * Shuts all doors of a name, as the two wings of a door. O(doors).
 *
 * @param name  UTF-8, with a zero byte at its end.
 * @return `SL_OK`, or `SL_ERROR_NOT_FOUND` if no door has that name.
 */
sl_status sl_viewer_close_doors_named(struct sl_viewer *viewer, const char *name);

/**
 * Opens all doors of a name. O(doors).
 *
 * @param name  UTF-8, with a zero byte at its end.
 * @return `SL_OK`, or `SL_ERROR_NOT_FOUND` if no door has that name.
 */
sl_status sl_viewer_open_doors_named(struct sl_viewer *viewer, const char *name);

/**
 * Follows the views into mirrors of the last look. What is found stays in the viewer until the next look. Allocates.
 *
 * @param bounces      The most mirrors one after another.
 * @param image_count  Where the number of images goes; images are numbered from 0, by ascending mirrors.
 * @return `SL_OK`.
 */
sl_status sl_viewer_follow_mirrors(struct sl_viewer *viewer, uint32_t bounces, uint32_t *image_count);

/**
 * Stores an image.
 *
 * @param image  Its number, below the count of `sl_viewer_follow_mirrors`.
 * @param out    Where it goes.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there is no such image.
 */
sl_status sl_viewer_image(const struct sl_viewer *viewer, uint32_t image, struct sl_image *out);

/**
 * The mirrors of an image, in the order in which a line from the eye meets them. In a scene each flat
 * rectangle of a mirror has a number of its own; in a plan it is that of the line.
 *
 * @param image     Its number, below the count of `sl_viewer_follow_mirrors`.
 * @param mirrors   Where their numbers go, or null to ask for how many there are.
 * @param capacity  Number of mirrors that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such image, or `SL_ERROR_BUFFER`.
 */
sl_status sl_viewer_image_mirrors(const struct sl_viewer *viewer,
                                  uint32_t image,
                                  uint32_t *mirrors,
                                  size_t capacity,
                                  size_t *count);

/**
 * The cells of an image, ascending.
 *
 * @param image     Its number, below the count of `sl_viewer_follow_mirrors`.
 * @param cells     Where their numbers go, or null to ask for how many there are.
 * @param capacity  Number of cells that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such image, or `SL_ERROR_BUFFER`.
 */
sl_status sl_viewer_image_cells(const struct sl_viewer *viewer,
                                uint32_t image,
                                uint32_t *cells,
                                size_t capacity,
                                size_t *count);

/**
 * The objects of an image, ascending.
 *
 * @param image     Its number, below the count of `sl_viewer_follow_mirrors`.
 * @param objects   Where their numbers go, or null to ask for how many there are.
 * @param capacity  Number of objects that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there is no such image, or `SL_ERROR_BUFFER`.
 */
sl_status sl_viewer_image_objects(const struct sl_viewer *viewer,
                                  uint32_t image,
                                  uint32_t *objects,
                                  size_t capacity,
                                  size_t *count);

/**
 * What suits most games with this table.
 *
 * @param options  Where they go.
 * @return `SL_OK`.
 */
sl_status sl_relevance_default_options(const struct sl_table *table, struct sl_relevance_options *options);

/**
 * Makes what follows bodies through a table.
 *
 * @param table      The table, which may be freed before. It is copied.
 * @param reaches    The path of a file that `sightlines relevance` made of this table. Null: the usual reaches are found now, which takes
 *                   seconds for thousands of cells.
 * @param options    Null for those of `sl_relevance_default_options`.
 * @param relevance  Where the handle goes; free it with `sl_relevance_free`. Null is stored there if the call fails.
 * @return `SL_OK`, `SL_ERROR_FILE`, `SL_ERROR_FORMAT` for a file that is damaged or of another table, or `SL_ERROR_ARGUMENT` for a table without
 *         places.
 */
sl_status sl_relevance_new(const struct sl_table *table,
                           const char *reaches,
                           const struct sl_relevance_options *options,
                           struct sl_relevance **relevance);

/**
 * Frees it.
 *
 * @param relevance  What no other thread is using, or null, for which nothing is done.
 */
void sl_relevance_free(struct sl_relevance *relevance);

/**
 * Finds who is shown to whom from now on. Somebody is told by the place in the list, from tick to tick. Call it at least once within the
 * tick that reaches were computed for.
 *
 * Errs towards shown: whoever comes to see somebody was told of them as long before as both take for their reach.
 *
 * @param now      Seconds, of any beginning, not descending.
 * @param players  All that move, and whoever watches.
 * @param count    Number of players.
 * @param changes  Where what changed goes; may be null.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` for a team or flags that are none. After a failure the last answer stands.
 */
sl_status sl_relevance_update(struct sl_relevance *relevance,
                              double now,
                              const struct sl_player *players,
                              size_t count,
                              struct sl_changes *changes);

/**
 * The pairs that are shown since the last tick: two numbers each, who is told and of whom.
 *
 * @param numbers   Where the numbers go, or null to ask for how many there are.
 * @param capacity  How many numbers the buffer has room for; 0 if it is null.
 * @param count     Where their number goes: twice that of the pairs.
 * @return `SL_OK`, or `SL_ERROR_BUFFER`.
 */
sl_status sl_relevance_gained(const struct sl_relevance *relevance, uint32_t *numbers, size_t capacity, size_t *count);

/**
 * The pairs that are no longer shown since the last tick: two numbers each, who is told and of whom.
 *
 * @param numbers   Where the numbers go, or null to ask for how many there are.
 * @param capacity  How many numbers the buffer has room for; 0 if it is null.
 * @param count     Where their number goes: twice that of the pairs.
 * @return `SL_OK`, or `SL_ERROR_BUFFER`.
 */
sl_status sl_relevance_lost(const struct sl_relevance *relevance, uint32_t *numbers, size_t capacity, size_t *count);

/**
 * Whether a pair was shown in the last tick: what a server asks before it transmits.
 *
 * @param to     Who is told.
 * @param of     Of whom.
 * @param shown  Where 1 goes if so, else 0.
 * @return `SL_OK`, or `SL_ERROR_ARGUMENT` if there was no such player.
 */
sl_status sl_relevance_is_shown(const struct sl_relevance *relevance, uint32_t to, uint32_t of, uint32_t *shown);

/**
 * Who was shown to somebody in the last tick, ascending.
 *
 * @param to        Who is told.
 * @param players   Where their numbers go, or null to ask for how many there are.
 * @param capacity  Number of players that the buffer has room for; 0 if it is null.
 * @param count     Where their number goes.
 * @return `SL_OK`, `SL_ERROR_ARGUMENT` if there was no such player, or `SL_ERROR_BUFFER`.
 */
sl_status sl_relevance_shown_to(const struct sl_relevance *relevance,
                                uint32_t to,
                                uint32_t *players,
                                size_t capacity,
                                size_t *count);

/**
 * Whether a body, within the reach of both, may come to see another: with both placed exactly, whatever the last tick said. Teams and flags
 * do not count.
 *
 * @param a    Who sees.
 * @param b    Who is seen.
 * @param may  Where 1 goes if so, else 0.
 * @return `SL_OK`.
 */
sl_status sl_relevance_may_see_within(struct sl_relevance *relevance,
                                      const struct sl_player *a,
                                      const struct sl_player *b,
                                      uint32_t *may);

/**
 * A lower bound of the time until a body may see another: 0 if it may at once, infinity if it never may.
 *
 * @param a        Who sees; its reach does not count.
 * @param b        Who is seen; its reach does not count.
 * @param speeds   Two numbers: the top speeds of both, in scene units a second.
 * @param seconds  Where the time goes.
 * @return `SL_OK`.
 */
sl_status sl_relevance_time_to_sight(struct sl_relevance *relevance,
                                     const struct sl_player *a,
                                     const struct sl_player *b,
                                     const double *speeds,
                                     double *seconds);

/**
 * Makes an empty scene.
 *
 * @param scene  Where the handle goes; free it with `sl_scene_free`.
 * @return `SL_OK`.
 */
sl_status sl_scene_new(struct sl_scene **scene);

/**
 * Frees a scene. Tables made of it stay.
 *
 * @param scene  A scene that no other thread is using, or null, for which nothing is done.
 */
void sl_scene_free(struct sl_scene *scene);

/**
 * Adds an object: what is seen or not as a whole. Everything is copied.
 *
 * @param name          UTF-8, with a zero byte at its end; null for no name.
 * @param vertices      x, y and z of one corner after the other, in scene units.
 * @param vertex_count  Number of corners.
 * @param indices       Three corners for each triangle, counter-clockwise as seen from the front.
 * @param index_count   Number of indices: three times the number of triangles.
 * @param flags         `SL_OBJECT_…`, joined by `|`; 0 for a wall, or anything else that hides.
 * @param object        Where its number goes, from 0 in the order of calls; the tables have the same. May be null.
 * @return `SL_OK`; `SL_ERROR_GEOMETRY` for a coordinate that is no finite number or too large, an index without a corner, or indices that
 *         are no triangles; `SL_ERROR_ARGUMENT` for unknown flags. After a failure the scene is as before.
 */
sl_status sl_scene_add_object(struct sl_scene *scene,
                              const char *name,
                              const double *vertices,
                              size_t vertex_count,
                              const uint32_t *indices,
                              size_t index_count,
                              uint32_t flags,
                              uint32_t *object);

/**
 * Adds an object with corners in single precision: as `sl_scene_add_object`.
 *
 * @param name          UTF-8, with a zero byte at its end; null for no name.
 * @param vertices      x, y and z of one corner after the other, in scene units.
 * @param vertex_count  Number of corners.
 * @param indices       Three corners for each triangle, counter-clockwise as seen from the front.
 * @param index_count   Number of indices: three times the number of triangles.
 * @param flags         `SL_OBJECT_…`, joined by `|`; 0 for a wall, or anything else that hides.
 * @param object        Where its number goes; may be null.
 * @return As `sl_scene_add_object`.
 */
sl_status sl_scene_add_object_f32(struct sl_scene *scene,
                                  const char *name,
                                  const float *vertices,
                                  size_t vertex_count,
                                  const uint32_t *indices,
                                  size_t index_count,
                                  uint32_t flags,
                                  uint32_t *object);

/**
 * States a box that an object never leaves, wherever it moves; it moves from then on, and hides nothing.
 *
 * @param object  Its number.
 * @param within  The box, in scene units; it is widened to where the object is at rest. Null: it may be anywhere.
 * @return `SL_OK`; `SL_ERROR_ARGUMENT` if there is no such object; `SL_ERROR_GEOMETRY` for a coordinate that cannot be used.
 */
sl_status sl_scene_set_motion(struct sl_scene *scene,
                              uint32_t object,
                              const struct sl_box *within);

/**
 * Makes the table of a scene. The same scene and options give the same table, byte for byte, with any number of threads, unless there is
 * a time limit.
 *
 * @param scene    The scene; it is not changed, and may be freed afterwards.
 * @param options  How to make it; null for all defaults.
 * @param table    Where the handle goes; free it with `sl_table_free`. Null is stored there if the call fails.
 * @param report   Where goes what was done, with `struct_size` set; may be null.
 * @return `SL_OK`; `SL_ERROR_GEOMETRY`, `SL_ERROR_BAKE` or `SL_ERROR_ARGUMENT` for what cannot be baked so; `SL_ERROR_CANCELLED`.
 */
sl_status sl_bake(const struct sl_scene *scene,
                  const struct sl_bake_options *options,
                  struct sl_table **table,
                  struct sl_bake_report *report);

/**
 * Makes the table of a plan: walls in the plane, which hide from both sides. Objects and doors belong to scenes.
 *
 * Of the options only `request`, `threads`, `progress` and `user` change anything; the others have to be valid all the same.
 *
 * @param walls       x and y of the two ends of one wall after the other: four numbers each.
 * @param wall_count  Number of walls.
 * @param options     How to make it; null for all defaults.
 * @param table       Where the handle goes; free it with `sl_table_free`. Null is stored there if the call fails.
 * @param report      Where goes what was done, with `struct_size` set; may be null.
 * @return `SL_OK`; `SL_ERROR_GEOMETRY` for walls that are no plan, `SL_ERROR_BAKE` if there is no room in it; `SL_ERROR_CANCELLED`.
 */
sl_status sl_bake_plan(const double *walls,
                       size_t wall_count,
                       const struct sl_bake_options *options,
                       struct sl_table **table,
                       struct sl_bake_report *report);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* SIGHTLINES_H */
