export const audit = {
  audit: {
    title: 'Audit',
    head: 'The chain',
    covered: '{number} {number|record|records}; the node’s signed head covers {signed} of them.',
    export: 'Export the log',
    exportHow: 'Anybody with the fleet’s public key checks it: trb audit verify',
    records: 'Records',
    number: 'Number',
    who: 'Who',
    nobody: 'nobody',
    action: 'What',
    about: 'About',
    outcome: 'Outcome',
    from: 'From',
    older: 'Older records',
  },
};
