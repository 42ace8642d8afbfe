/* A server that does not send what cannot be seen in time: four players in two rooms, one of whom walks out into the corridor.
 *
 * cc -std=c11 transmit.c -I include -L target/release -lsightlines_capi
 */
#include <sightlines.h>

#include <stdio.h>
#include <stdlib.h>

enum { PLAYERS = 4 };

static void need(sl_status status, const char *what) {
    if (status != SL_OK) {
        fprintf(stderr, "%s: %s: %s\n", what, sl_status_name(status), sl_last_error());
        exit(EXIT_FAILURE);
    }
}

/* Somebody half a metre wide whose feet are here, who runs at 5 m/s: round trip, interpolation and a tick take 228 ms. */
static sl_player at(double x, double y) {
    sl_player player = {.reach = 5 * 0.228, .flags = SL_PLAYER_VIEWS | SL_PLAYER_IS_SEEN};
    player.seen = (sl_box){{x - 0.25, y - 0.25, 0}, {x + 0.25, y + 0.25, 0}};
    player.eyes = player.seen;
    return player;
}

int main(void) {
    /* Two rooms of 8 x 8 m, each with a door to the corridor east of them: a plan, so that z does not count. A game would load level.pvs. */
    const double walls[] = {0, 0, 10, 0, 10, 0, 10, 16, 10, 16, 0, 16, 0, 16, 0, 0, 0, 8, 8, 8, 8, 0, 8, 1, 8, 2, 8, 14, 8, 15, 8, 16};
    sl_table *table = NULL;
    need(sl_bake_plan(walls, sizeof walls / sizeof walls[0] / 4, NULL, &table, NULL), "bake");
    sl_relevance *relevance = NULL;
    /* A game would name level.rel here, made by `sightlines relevance level.pvs -o level.rel`. */
    need(sl_relevance_new(table, NULL, NULL, &relevance), "relevance");
    sl_table_free(table);

    sl_player players[PLAYERS] = {at(1, 1.5), at(4, 4), at(2, 14.5), at(6, 10)};
    unsigned sent = 0;
    for (int tick = 0; tick < 600; ++tick) {
        /* The first walks through the door and along the corridor. */
        const double way = 5 * tick / 128.0;
        players[0] = way < 8 ? at(1 + way, 1.5) : at(9, 1.5 + (way - 8 < 13 ? way - 8 : 13));
        need(sl_relevance_update(relevance, tick / 128.0, players, PLAYERS, NULL), "update");

        uint32_t pairs[2 * PLAYERS * PLAYERS];
        size_t count = 0;
        need(sl_relevance_gained(relevance, pairs, 2 * PLAYERS * PLAYERS, &count), "gained");
        for (size_t i = 0; i < count; i += 2) {
            printf("tick %d: %u is told of %u\n", tick, (unsigned)pairs[i], (unsigned)pairs[i + 1]);
        }
        for (uint32_t to = 0; to < PLAYERS; ++to) {
            for (uint32_t of = 0; of < PLAYERS; ++of) {
                uint32_t shown = 0;
                need(sl_relevance_is_shown(relevance, to, of, &shown), "is_shown"); /* the transmit check */
                sent += shown;
            }
        }
    }
    double seconds = 0;
    const double speeds[] = {5, 5};
    need(sl_relevance_time_to_sight(relevance, &players[1], &players[2], speeds, &seconds), "time to sight");
    printf("1 sees 2 in %.2f seconds at the soonest\n", seconds);
    printf("%.0f %% of the positions sent\n", 100.0 * sent / (600 * PLAYERS * (PLAYERS - 1)));
    sl_relevance_free(relevance);
    return 0;
}
