/* process.h: what the system knows of this process. */
#ifndef SERVER_PROCESS_H
#define SERVER_PROCESS_H

/* Negative: the system does not tell. */
typedef struct process_figures {
    double processor_s; /* of all threads */
    double started_s;   /* when process_note_start was called, since 1970 */
    double descriptors, descriptors_greatest;
    double memory_bytes; /* resident */
} process_figures;

/* Notes that the process begins now. Before the first thread. */
void process_note_start(void);

process_figures process_look(void);

#endif
