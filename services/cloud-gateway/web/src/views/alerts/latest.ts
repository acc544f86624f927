/** One request at a time. Of the wishes that come meanwhile only the last one is sent: a slider makes many. */
export class Latest<Wish> {
  private next: { wish: Wish } | null = null;
  private isBusy = false;

  constructor(
    private readonly send: (wish: Wish) => Promise<void>,
    private readonly rest: () => Promise<void> = () => new Promise((done) => setTimeout(done, 100)),
  ) {}

  async want(wish: Wish): Promise<void> {
    this.next = { wish };
    if (this.isBusy) return;
    this.isBusy = true;
    while (this.next !== null) {
      const { wish: now } = this.next;
      this.next = null;
      await this.send(now);
      await this.rest();
    }
    this.isBusy = false;
  }

  drop(): void {
    this.next = null;
  }
}
