/* Answers the test rig over UDP with a controller of wheel_slide.h; the page In the loop has the protocol.
 *
 *     cc -O2 -o client udp_client.c mine.c            (Windows: cl udp_client.c mine.c ws2_32.lib)
 *     ./client 192.168.0.7 5005                       (without arguments: 127.0.0.1 5005)
 *
 * It ends with 0 if the rig reports the end of the run, with 1 if the rig stops sending or cannot be reached. */
#if defined(_WIN32)
#include <winsock2.h>
#include <ws2tcpip.h>
#define LENGTH (int)
#else
#define _POSIX_C_SOURCE 200112L
#include <netdb.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <sys/types.h>
typedef int SOCKET;
#define LENGTH (size_t)
#define INVALID_SOCKET (-1)
#endif

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "wheel_slide.h"

enum { HELLO = 1, SPEEDS = 2, ANSWER = 3, END = 4 };
/* Bytes before the speeds and before the valves, most wheelsets, hellos a second, seconds after which the rig is silent. */
enum { HEADER = 12, QUESTION = 28, MOST = 16, EVERY = 5, SILENCE = 10 };

static uint64_t whole(const unsigned char *from, int bytes) {
    uint64_t value = 0;
    for (int i = bytes - 1; i >= 0; --i) value = value << 8 | from[i];
    return value;
}

static double number(const unsigned char *from) {
    const uint64_t bits = whole(from, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void head(unsigned char *to, int kind, int wheelsets, uint32_t sequence) {
    memcpy(to, "WSP1", 4);
    to[4] = (unsigned char)kind;
    to[6] = (unsigned char)wheelsets;
    to[5] = to[7] = 0;
    for (int i = 0; i < 4; ++i) to[8 + i] = (unsigned char)(sequence >> 8 * i);
}

/* A socket that receives from the rig alone, or INVALID_SOCKET. */
static SOCKET reached(const char *host, const char *port) {
    struct addrinfo wanted, *found = NULL;
    memset(&wanted, 0, sizeof wanted);
    wanted.ai_family = AF_INET;
    wanted.ai_socktype = SOCK_DGRAM;
    if (getaddrinfo(host, port, &wanted, &found) != 0) return INVALID_SOCKET;
    const SOCKET own = socket(found->ai_family, found->ai_socktype, found->ai_protocol);
    const int failed = own == INVALID_SOCKET || connect(own, found->ai_addr, (socklen_t)found->ai_addrlen) != 0;
    freeaddrinfo(found);
    return failed ? INVALID_SOCKET : own;
}

/* The length of the next packet; 0: none came for a while, or the rig does not listen. */
static int heard(SOCKET own, unsigned char *packet, int most) {
    fd_set ready;
    struct timeval wait = {0, 1000000 / EVERY};
    FD_ZERO(&ready);
    FD_SET(own, &ready);
    if (select((int)own + 1, &ready, NULL, NULL, &wait) <= 0) return 0;
    const int length = (int)recv(own, (char *)packet, LENGTH(most), 0);
    if (length >= 0) return length;
    wait.tv_sec = 0;
    wait.tv_usec = 1000000 / EVERY;
    (void)select(0, NULL, NULL, NULL, &wait);
    return 0;
}

/* Lets the controller answer a question; its memory is allocated at the first one. Returns 0 if out of memory. */
static int answer(SOCKET own, const unsigned char *packet, int n, void **memory) {
    unsigned char reply[HEADER + MOST];
    double speed[MOST];
    int valve[MOST] = {WHEEL_SLIDE_APPLY};
    if (!*memory) {
        const size_t size = wheel_slide_size(n);
        *memory = calloc(1, size ? size : 1);
        if (!*memory) return 0;
        wheel_slide_start(*memory, n, number(packet + 20));
    }
    for (int i = 0; i < n; ++i) speed[i] = number(packet + QUESTION + 8 * i);
    wheel_slide_step(*memory, number(packet + HEADER), speed, valve);
    head(reply, ANSWER, n, (uint32_t)whole(packet + 8, 4));
    for (int i = 0; i < n; ++i) reply[HEADER + i] = (unsigned char)valve[i];
    (void)send(own, (const char *)reply, LENGTH(HEADER + n), 0);
    return 1;
}

/* Returns 0 at the end of the run, or 1 if the rig is silent for too long within a run. */
static int serve(SOCKET own) {
    unsigned char packet[2048], hello[HEADER];
    void *memory = NULL;
    head(hello, HELLO, 0, 0);
    for (int silent = 0; silent < EVERY * SILENCE || !memory; ++silent) {
        if (!memory) (void)send(own, (const char *)hello, HEADER, 0);
        const int length = heard(own, packet, (int)sizeof packet);
        if (length < HEADER || memcmp(packet, "WSP1", 4) != 0) continue;
        const int kind = (int)whole(packet + 4, 2), n = (int)whole(packet + 6, 2);
        if (kind == END) {
            free(memory);
            return 0;
        }
        if (kind != SPEEDS || n > MOST || length != QUESTION + 8 * n) continue;
        if (!answer(own, packet, n, &memory)) break;
        silent = 0;
    }
    free(memory);
    return 1;
}

int main(int count, char **given) {
    const char *host = count > 1 ? given[1] : "127.0.0.1", *port = count > 2 ? given[2] : "5005";
#if defined(_WIN32)
    WSADATA about;
    if (WSAStartup(MAKEWORD(2, 2), &about) != 0) return 1;
#endif
    const SOCKET own = reached(host, port);
    if (own == INVALID_SOCKET) {
        fprintf(stderr, "There is no way to %s, port %s; give the host and port of the rig.\n", host, port);
        return 1;
    }
    const int status = serve(own);
    if (status) fprintf(stderr, "The rig asked nothing for %d s, or there is no memory.\n", SILENCE);
    return status;
}
