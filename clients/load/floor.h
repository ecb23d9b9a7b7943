/* floor.h: the bare server that awtd is measured against: what TCP and poll() alone cost on this machine. It parses
 * nothing beyond a length: a ping is answered with so many bytes as it asks for, and a fan too, with as many to every
 * connection that has joined its group. One thread, one poll set, a process of its own.
 *
 * Request, little-endian: u32 bytes of the whole request, u32 bytes of the whole answer, u32 what, u32 group, u64 id,
 * then anything. Answer: u32 bytes of the whole answer, u32 0, u64 id, then zeros. */
#ifndef LOAD_FLOOR_H
#define LOAD_FLOOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

enum { FLOOR_PING, FLOOR_JOIN, FLOOR_FAN };

enum {
    FLOOR_REQUEST_SIZE = 24,
    FLOOR_REQUEST_MOST = 4096,
    FLOOR_ANSWER_SIZE = 16,
    FLOOR_ANSWER_MOST = 64 << 20,
    FLOOR_ADDRESS = 64
};

typedef struct floor_request {
    uint32_t size, answer, what, group;
    uint64_t id;
} floor_request;

typedef struct floor_answer {
    uint32_t size;
    uint64_t id;
} floor_answer;

void floor_request_write(const floor_request *r, unsigned char bytes[FLOOR_REQUEST_SIZE]);
floor_request floor_request_read(const unsigned char bytes[FLOOR_REQUEST_SIZE]);
void floor_answer_write(const floor_answer *a, unsigned char bytes[FLOOR_ANSWER_SIZE]);
floor_answer floor_answer_read(const unsigned char bytes[FLOOR_ANSWER_SIZE]);

/* A listening descriptor at "HOST:PORT" (port 0: any), with the place it got in `bound`; -1: `error` says why. */
int floor_listen(const char *address, char bound[FLOOR_ADDRESS], char *error, size_t error_size);

/* Serves until `lifeline` (a descriptor; -1: none) ends, or there is no memory. Owns the listener. */
void floor_serve(int listener, int lifeline);

/* The bare server as a process of its own, on a free port of the loopback. */
typedef struct floor_process {
    pid_t pid;
    int lifeline; /* it lives as long as this is open, so that it never outlives us */
    char address[FLOOR_ADDRESS];
} floor_process;

/* Before any thread is started. False: `error` says why. */
bool floor_start(floor_process *p, char *error, size_t error_size);
/* Accepts a zeroed process. */
void floor_stop(floor_process *p);

#endif
