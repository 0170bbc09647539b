// The server's side: what it sends when a file was saved, and what the page asks for.

class Live {
  constructor(handlers) {
    this.handlers = handlers;
    this.token = new URLSearchParams(location.search).get('token') ?? '';
    this.wait = 500;
    this.asked = 0;
    this.connect();
  }

  connect() {
    const events = new EventSource(`/live?token=${encodeURIComponent(this.token)}`);
    events.addEventListener('open', () => { this.wait = 500; this.handlers.connected(true); });
    events.addEventListener('message', (event) => this.handlers.message(JSON.parse(event.data)));
    events.addEventListener('error', () => {
      // Left to itself it comes back only to a server that answered well.
      events.close();
      this.handlers.connected(false);
      setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(this.wait * 2, 10000);
    });
  }

  async get(path, parameters) {
    const query = new URLSearchParams({ ...parameters, token: this.token });
    const response = await fetch(`${path}?${query}`);
    return response.ok ? response.json() : null;
  }

  again() {
    return fetch(`/relearn?token=${encodeURIComponent(this.token)}`, { method: 'POST' });
  }

  /** Another value of a parameter of the script: what a save does happens then. */
  set(save, name, value) {
    return fetch(`/param?${new URLSearchParams({ save, name, value, token: this.token })}`, { method: 'POST' });
  }

  /** The steps of a seed that the document left out. */
  tracks(save, seed) {
    return this.get('/track', { save, seed });
  }

  /** One moment in pictures; only the last question is answered. */
  async frame(save, seed, phase, step, done) {
    this.next = { save, seed, phase, step, done };
    if (this.busy) return;
    this.busy = true;
    while (this.next) {
      const { done: then, ...question } = this.next;
      this.next = null;
      try {
        const shot = await this.get('/frame', question);
        if (shot) then(shot);
      } catch { /* the server is gone; the stream of events says so */ }
    }
    this.busy = false;
  }
}
